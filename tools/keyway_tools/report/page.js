"use strict";
// The view in space and the plots of a report. Data come from the script element "data".
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const kinds = { f4: Float32Array, i4: Int32Array, i2: Int16Array };
  const element = id => document.getElementById(id);
  const failed = error => { document.body.dataset.failed = String(error); throw error; };

  // An array from base64: numbers one after the other, the lowest byte first.
  const unpack = packed => {
    const bytes = Uint8Array.from(atob(packed.data), c => c.charCodeAt(0));
    const numbers = new kinds[packed.kind](bytes.buffer);
    return packed.scale === undefined ? numbers : Float32Array.from(numbers, v => v * packed.scale);
  };
  const column = (numbers, k) => {
    const found = new Float32Array(numbers.length / 3);
    for (let i = 0; i < found.length; i++) found[i] = numbers[3 * i + k];
    return found;
  };
  const corners = triangles => [0, 1, 2].map(k => {
    const found = new Int32Array(triangles.length / 3);
    for (let i = 0; i < found.length; i++) found[i] = triangles[3 * i + k];
    return found;
  });
  const words = (value, digits = 4) => String(Number(value.toPrecision(digits)));

  // One dam: what is drawn at a time, in a field, with an enlargement.
  class Dam {
    constructor(scene, number) {
      this.scene = scene;
      this.box = element(`space-${number}`);
      this.caption = element(`caption-${number}`);
      this.image = element(`image-${number}`);
      this.key = element(`legend-${number}`);
      this.x = unpack(scene.x);
      this.skins = scene.skins.map(one => ({ corners: corners(unpack(one.triangles)), edges: unpack(one.edges) }));
      this.fields = scene.fields.map(one => ({ ...one, values: unpack(one.values) }));
      this.states = scene.states && { ...scene.states, u: unpack(scene.states.u) };
      this.modes = scene.modes && { ...scene.modes, shapes: unpack(scene.modes.shapes) };
      this.joints = scene.joints && { ...scene.joints, x: unpack(scene.joints.x), values: unpack(scene.joints.values) };
      this.count = this.x.length;
    }

    at(all, k) { return all.subarray(k * this.count, (k + 1) * this.count); }

    nearest(time) {
      const times = this.states.times;
      let best = 0;
      times.forEach((t, k) => { if (Math.abs(t - time) < Math.abs(times[best] - time)) best = k; });
      return best;
    }

    // Displacements as drawn [m], sizes of them, and a caption, for a choice of the reader.
    shift(choice) {
      if (choice.show.startsWith("mode:") && this.modes) {
        const k = Math.min(Number(choice.show.slice(5)), this.modes.hz.length - 1);
        const shape = this.at(this.modes.shapes, k);
        const by = this.modes.amplitude * choice.factor * Math.sin(choice.phase);
        return { u: shape, by, text: `mode ${k + 1}: ${words(this.modes.hz[k])} Hz`, skin: 0 };
      }
      if (!this.states) return { u: null, by: 0, text: "", skin: 0 };
      const k = this.nearest(choice.time);
      const by = this.states.factor * choice.factor;
      const text = `t = ${words(this.states.times[k], 6)} s, displacements drawn ${words(by, 3)} times`;
      // Envelopes and joints are those of the last step: the whole dam.
      const skin = choice.show === "displacement" ? this.states.skins[k] : 0;
      return { u: this.at(this.states.u, k), by, text, skin };
    }

    colours(choice, shift) {
      const field = this.fields.find(one => one.name === choice.show);
      if (field) {
        const remark = field.remark ? ` (${field.remark})` : "";
        return { values: field.values, ends: field.ends, scale: field.colours, unit: field.unit, label: field.label + remark };
      }
      const values = new Float32Array(this.count / 3);
      if (choice.show === "joints" || !shift.u) return { values, none: true, unit: "", label: "" };
      const isMode = choice.show.startsWith("mode:");
      for (let i = 0; i < values.length; i++) values[i] = Math.hypot(shift.u[3 * i], shift.u[3 * i + 1], shift.u[3 * i + 2]) * (isMode ? 1 : 1e3);
      const ends = isMode ? [0, 1] : this.states.ends;
      return { values, ends, scale: isMode ? this.modes.colours : this.states.colours, unit: isMode ? "" : "mm", label: isMode ? "size over the largest" : "displacement" };
    }

    traces(choice) {
      const shift = this.shift(choice), paint = this.colours(choice, shift);
      const x = new Float32Array(this.x);
      if (shift.u) for (let i = 0; i < x.length; i++) x[i] += shift.by * shift.u[i];
      const { corners: [i, j, k], edges } = this.skins[shift.skin];
      const largest = paint.values.reduce((a, b) => Math.abs(b) > Math.abs(a) ? b : a, 0);
      this.text = [paint.label, shift.text].filter(Boolean).join("; ");
      this.caption.dataset.largest = largest;
      this.caption.textContent = this.text + (paint.none ? "" : `; largest shown ${words(largest)} ${paint.unit}`);
      const body = { type: "mesh3d", x: column(x, 0), y: column(x, 1), z: column(x, 2), i, j, k, flatshading: true, lighting: { ambient: .85, diffuse: .3, specular: 0 }, hovertemplate: "(%{x:.4g}, %{y:.4g}, %{z:.4g}) m<br>%{text}<extra></extra>" };
      if (paint.none) Object.assign(body, { intensity: paint.values, cmin: 0, cmax: 1, colorscale: [[0, "#c9c4bc"], [1, "#c9c4bc"]], showscale: false, opacity: choice.show === "joints" ? .35 : 1, text: "" });
      else Object.assign(body, { intensity: paint.values, cmin: paint.ends[0], cmax: paint.ends[1], colorscale: paint.scale, showscale: false, text: Array.from(paint.values, v => `${words(v, 3)} ${paint.unit}`) });
      const found = [body, this.wire(x, edges)], isOfJoints = choice.show === "joints" && this.joints;
      if (isOfJoints) found.push(this.joint());
      this.legend(isOfJoints ? { ends: this.joints.ends, scale: this.joints.colours, unit: "mm" } : paint);
      return found;
    }

    wire(x, edges) {
      const line = [[], [], []];
      for (let n = 0; n < edges.length; n += 2) {
        for (let k = 0; k < 3; k++) line[k].push(x[3 * edges[n] + k], x[3 * edges[n + 1] + k], null);
      }
      return { type: "scatter3d", mode: "lines", x: line[0], y: line[1], z: line[2], line: { color: "#444", width: 2 }, hoverinfo: "skip", showlegend: false };
    }

    joint() {
      const joint = this.joints, [i, j, k] = corners(unpack(joint.triangles));
      const largest = joint.values.reduce((a, b) => Math.max(a, b), 0);
      this.caption.dataset.largest = largest;
      this.caption.textContent = `${joint.label}; largest shown ${words(largest)} mm`;
      return { type: "mesh3d", x: column(joint.x, 0), y: column(joint.x, 1), z: column(joint.x, 2), i, j, k, intensity: joint.values, cmin: joint.ends[0], cmax: joint.ends[1], colorscale: joint.colours, showscale: false, lighting: { ambient: .9, diffuse: .2 }, text: Array.from(joint.values, v => `${words(v, 3)} mm`), hovertemplate: "(%{x:.4g}, %{y:.4g}, %{z:.4g}) m<br>%{text}<extra></extra>" };
    }

    layout() {
      // The room of the largest displacements is kept, so that the dam does not jump in motion.
      const range = [0, 1, 2].map(k => {
        let low = Infinity, high = -Infinity;
        for (let n = k; n < this.x.length; n += 3) { low = Math.min(low, this.x[n]); high = Math.max(high, this.x[n]); }
        return [low, high];
      });
      const margin = .1 * Math.max(...range.map(([low, high]) => high - low));
      // The same scale along all axes; plotly's own choice enlarges thin bodies out of sight.
      const sizes = range.map(([low, high]) => high - low + 2 * margin);
      const scale = Math.min(...sizes.map((size, k) => (k === this.scene.up ? 1.5 : 2.2) / size));
      const [rx, ry, rz] = sizes;
      const up = Object.fromEntries([..."xyz"].map((name, k) => [name, Number(k === this.scene.up)]));
      const axis = k => ({ title: { text: `${"xyz"[k]} [m]` }, range: [range[k][0] - margin, range[k][1] + margin], autorange: false, backgroundcolor: "#fafafa", gridcolor: "#e5e5e5" });
      return { margin: { l: 0, r: 0, t: 0, b: 0 }, uirevision: "kept", showlegend: false, scene: { xaxis: axis(0), yaxis: axis(1), zaxis: axis(2), aspectmode: "manual", aspectratio: { x: scale * rx, y: scale * ry, z: scale * rz }, camera: { eye: this.scene.eye, up, projection: { type: "orthographic" } } } };
    }

    draw(choice) {
      return Plotly.react(this.box, this.traces(choice), this.drawn ||= this.layout(), { responsive: true, displaylogo: false });
    }

    // The colours below the dam: bands, and numbers at some of their borders.
    legend(paint) {
      const bands = paint.none ? 0 : paint.scale.length / 2;
      this.key.style.visibility = bands ? "visible" : "hidden";
      if (!bands) return;
      const stops = paint.scale.map(([at, colour]) => `${colour} ${100 * at}%`);
      this.key.firstElementChild.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
      const every = Math.ceil(bands / 6), [low, high] = paint.ends, texts = [];
      for (let k = 0; k <= bands; k += every) texts.push([k / bands, words(low + (high - low) * k / bands, 3)]);
      this.key.lastElementChild.replaceChildren(...texts.map(([at, text], n) => {
        const label = document.createElement("span");
        label.style.left = `${100 * at}%`;
        label.textContent = n === texts.length - 1 ? `${text} ${paint.unit}` : text;
        return label;
      }));
    }

    // The image on paper is what the screen shows; the drawing itself is lost there.
    snapshot() {
      this.image.src = this.box._fullLayout.scene._scene.toImage("png");
      return this.image.decode();
    }
  }

  const plots = [];
  const curves = (box, plot) => {
    const layout = { title: { text: plot.title, x: 0, font: { size: 16 } }, margin: { l: 70, r: 10, t: 40, b: 45 }, xaxis: { title: { text: "time [s]" } }, yaxis: { title: { text: plot.unit } }, legend: { orientation: "v" }, hovermode: "x unified", showlegend: true };
    plots.push(Plotly.newPlot(box, plot.curves.map(one => ({ ...one, mode: one.x.length < 3 ? "lines+markers" : "lines", line: { width: 1.4 } })), layout, { responsive: true, displaylogo: false }));
  };
  const bars = (box, rows) => {
    const ordered = [...rows].reverse();
    const layout = { margin: { l: 240, r: 10, t: 10, b: 45 }, xaxis: { title: { text: "time [s]" } } };
    plots.push(Plotly.newPlot(box, [{ type: "bar", orientation: "h", x: ordered.map(r => r.seconds), y: ordered.map(r => r.name), marker: { color: "#0072B2" } }], layout, { responsive: true, displaylogo: false }));
  };

  const dams = [];
  const choice = { show: "", time: 0, factor: 1, phase: Math.PI / 2 };
  let times = [], timer = null;

  const fill = select => {
    const known = new Map();
    for (const dam of dams) {
      if (dam.states) known.set("displacement", "displacement");
      for (const field of dam.fields) known.set(field.name, field.label);
      if (dam.joints) known.set("joints", dam.joints.label);
      if (dam.modes) dam.modes.hz.forEach((hz, k) => known.set(`mode:${k}`, `mode ${k + 1}${dams.length > 1 ? "" : `, ${words(hz)} Hz`}`));
    }
    if (!known.size) known.set("", "the mesh");
    for (const [value, text] of known) select.add(new Option(text, value));
    choice.show = select.value;
  };

  const draw = async () => {
    choice.time = times[Number(element("time").value)] ?? 0;
    choice.factor = Number(element("factor").value) / 100;
    choice.show = element("field").value;
    const isMode = choice.show.startsWith("mode:");
    element("time-label").style.visibility = times.length && !isMode ? "visible" : "hidden";
    element("time-shown").textContent = times.length ? `${words(choice.time, 6)} s` : "";
    element("factor-shown").textContent = `${words(100 * choice.factor, 3)} %`;
    await Promise.all(dams.map(dam => dam.draw(choice)));
  };

  const step = () => {
    if (choice.show.startsWith("mode:")) choice.phase += Math.PI / 12;
    else if (times.length) element("time").value = (Number(element("time").value) + 1) % times.length;
    draw().catch(failed);
  };
  const play = () => {
    timer = timer ? clearInterval(timer) : setInterval(step, 80);
    element("play").textContent = timer ? "stop" : "play";
    if (!timer) { choice.phase = Math.PI / 2; draw().catch(failed); }
  };

  // On paper: the dam as an image, plots as wide as the paper.
  const width = document.body.classList.contains("pair") ? 480 : 680;
  const resize = change => document.querySelectorAll(".plot").forEach(box => box.layout && Plotly.relayout(box, change));
  window.addEventListener("beforeprint", () => {
    dams.forEach(dam => dam.snapshot().catch(failed));
    resize({ width });
  });
  window.addEventListener("afterprint", () => resize({ width: null, autosize: true }));

  const start = async () => {
    data.runs.forEach((run, number) => {
      if (run.scene) dams.push(new Dam(run.scene, number));
      run.plots.forEach((plot, k) => curves(element(`plot-${number}-${k}`), plot));
      if (run.ledger.length) bars(element(`ledger-${number}`), run.ledger);
    });
    await Promise.all(plots);
    if (!dams.length) {
      document.querySelector(".controls").style.display = "none";
      document.body.dataset.ready = "yes";
      return;
    }
    fill(element("field"));
    times = [...new Set(dams.flatMap(dam => dam.states ? dam.states.times : []))].sort((a, b) => a - b);
    element("time").max = Math.max(times.length - 1, 0);
    element("time").value = Math.max(times.indexOf(data.time), 0);
    for (const id of ["time", "factor", "field"]) element(id).addEventListener("input", () => draw().catch(failed));
    element("play").addEventListener("click", play);
    await draw();
    document.body.dataset.ready = "yes";
  };
  start().catch(failed);
})();
