"""`mocc lsp` with pytest-lsp, whose client checks each message against the types of the protocol.

    pip install pytest-lsp
    MOCC=target/release/mocc pytest tests/editor
"""

import os
import pathlib

import pytest_lsp
from lsprotocol import types
from pytest_lsp import ClientServerConfig, LanguageClient

ROOT = pathlib.Path(__file__).resolve().parents[2]
VALVE = ROOT / "examples" / "valve52.mol"


@pytest_lsp.fixture(config=ClientServerConfig(server_command=[os.environ.get("MOCC", "mocc"), "lsp"]))
async def client(lsp_client: LanguageClient):
    parameters = types.InitializeParams(capabilities=types.ClientCapabilities())
    result = await lsp_client.initialize_session(parameters)
    assert result.server_info.name == "mocc"
    yield
    await lsp_client.shutdown_session()


def open_text(client, uri, text, language="modelica"):
    item = types.TextDocumentItem(uri=uri, language_id=language, version=1, text=text)
    client.text_document_did_open(types.DidOpenTextDocumentParams(text_document=item))
    return types.TextDocumentIdentifier(uri=uri)


def place_of(text, words, offset=0):
    before = text[: text.index(words) + offset]
    return types.Position(line=before.count("\n"), character=len(before) - before.rfind("\n") - 1)


async def test_the_valve_has_hints_lenses_and_references(client):
    text = VALVE.read_text()
    document = open_text(client, VALVE.as_uri(), text)
    await client.wait_for_notification(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
    assert len(client.diagnostics[VALVE.as_uri()]) == 0

    whole = types.Range(types.Position(0, 0), types.Position(text.count("\n") + 1, 0))
    hints = await client.text_document_inlay_hint_async(types.InlayHintParams(document, whole))
    labels = [hint.label for hint in hints]
    assert "Pa" in labels and "= 0.03 kg" in labels and len(labels) > 50

    lenses = await client.text_document_code_lens_async(types.CodeLensParams(document))
    assert [lens.command.title for lens in lenses] == ["Simulate", "Report", "Check"]

    place = place_of(text, "s_max = s_max", 1)
    references = await client.text_document_references_async(
        types.ReferenceParams(types.ReferenceContext(True), document, place_of(text, "s_max          = 3.5e-3"))
    )
    assert len(references) >= 2
    hover = await client.text_document_hover_async(types.HoverParams(document, place))
    assert "Stop" in hover.contents.value or "m" in hover.contents.value


async def test_a_mistake_has_a_diagnostic_and_a_repair(client):
    text = VALVE.read_text().replace("connect(pilot.y", "connect(pilt.y") if "pilot.y" in VALVE.read_text() else None
    text = text or VALVE.read_text().replace("StopMass spool(m = m", "StopMass spool(mm = m")
    uri = VALVE.with_name("wrong.mol").as_uri()
    document = open_text(client, uri, text)
    await client.wait_for_notification(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
    found = client.diagnostics[uri]
    assert found and found[0].code.startswith("MO")
    context = types.CodeActionContext(diagnostics=found)
    actions = await client.text_document_code_action_async(
        types.CodeActionParams(document, found[0].range, context)
    )
    assert actions and actions[0].kind == types.CodeActionKind.QuickFix


async def test_keys_of_plans_are_completed(client):
    text = '[goal]\n'
    document = open_text(client, VALVE.with_name("p.toml").as_uri(), text, "toml")
    items = await client.text_document_completion_async(
        types.CompletionParams(document, types.Position(1, 0))
    )
    assert [item.label for item in items] == ["minimize", "maximize"]
