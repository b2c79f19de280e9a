"""tools/accuracy: decks read as the program reads them, and written again."""

from keyway_tools.study.deck_cards import Card, number_of, read_deck


def test_reader_takes_continuations_quotes_and_includes(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in/mesh.inp").write_text("*node, nset = All\n1, 0., 0.\n** remark\n 2,1.,0.,0.\n")
    text = '*Include, input="in/mesh.inp"\n*RESERVOIR, NAME=LAKE,\n  LEVEL=5., ADDED MASS=NONE\n'
    (tmp_path / "a.inp").write_text(text + "*amplitude, name=A, input=x.txt\n*STATIC\n1., 1.\n")
    deck = read_deck(tmp_path / "a.inp")
    node, reservoir, amplitude, static = deck.cards
    assert (node.keyword, node.value("NSET"), node.lines) == (
        "NODE", "ALL", ["1, 0., 0.", "2,1.,0.,0."],
    )  # fmt: skip
    assert reservoir.parameters == {"NAME": "LAKE", "LEVEL": "5.", "ADDED MASS": "NONE"}
    assert amplitude.parameters["INPUT"] == f'"{tmp_path / "x.txt"}"'
    assert [number_of(item) for item in static.lines[0].split(",")] == [1.0, 1.0]
    (tmp_path / "b.inp").write_text(deck.text())
    assert read_deck(tmp_path / "b.inp") == deck


def test_reader_knows_the_parameters_of_each_keyword(tmp_path):
    """By the list of keyway.deck: a flag goes on with its keyword, a word of data does not."""
    text = (
        "*CONTROLS,\nRESET\n*DYNAMIC,\n NoHaf, Direct\n0.01, 1.\n*nset, nset=A,\nRESET,\n"
        '*ELFILE, ELSET="Left, right"\nS\n'
    )
    (tmp_path / "a.inp").write_text(text)
    controls, dynamic, nodes, file = read_deck(tmp_path / "a.inp").cards
    assert (controls.parameters, controls.lines) == ({"RESET": None}, [])
    assert (dynamic.parameters, dynamic.lines) == ({"NOHAF": None, "DIRECT": None}, ["0.01, 1."])
    assert (nodes.parameters, nodes.lines) == ({"NSET": "A"}, ["RESET,"])
    assert file == Card("EL FILE", {"ELSET": '"Left, right"'}, ["S"])
