// The search of the site runs in a worker. Browsers start no workers for pages that are opened from
// disk (file:), so there the worker's script runs in a hidden frame, with the same messages.
class FrameWorker extends EventTarget {
  constructor(url) {
    super();
    this.waiting = [];
    this.frame = document.createElement("iframe");
    this.frame.hidden = true;
    document.body.appendChild(this.frame);
    const source = new URL(url, document.baseURI).href;
    const load = () => this.load(source);
    if (this.frame.contentDocument.readyState === "complete") load();
    else this.frame.addEventListener("load", load, { once: true });
  }

  load(source) {
    const inside = this.frame.contentWindow;
    inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
    const script = inside.document.createElement("script");
    script.src = source;
    script.addEventListener("load", () => {
      this.deliver = (data) => inside.dispatchEvent(new MessageEvent("message", { data }));
      this.waiting.forEach(this.deliver);
    });
    inside.document.body.appendChild(script);
  }

  postMessage(data) {
    if (this.deliver) this.deliver(data);
    else this.waiting.push(data);
  }

  terminate() {
    this.frame.remove();
  }
}

if (location.protocol === "file:") window.Worker = FrameWorker;
