// Connects Visual Studio Code with `mocc lsp`. The protocol's client is that of `vscode-languageclient`, which the
// packaging script adds.
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function program() {
  return vscode.workspace.getConfiguration("mocc").get("path", "mocc");
}

// Runs a command of mocc on the file of the active editor, in a terminal.
function onFile(command) {
  return async () => {
    const editor = vscode.window.activeTextEditor;
    if (!editor) {
      return;
    }
    await editor.document.save();
    const terminal = vscode.window.terminals.find((t) => t.name === "mocc") ?? vscode.window.createTerminal("mocc");
    terminal.show(true);
    terminal.sendText(`${program()} ${command} "${editor.document.uri.fsPath}"`);
  };
}

function activate(context) {
  const server = { command: program(), args: ["lsp"] };
  client = new LanguageClient("mocc", "mocc", server, {
    documentSelector: [{ language: "modelica" }],
    synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{mo,mol,toml}") },
  });
  const register = vscode.commands.registerCommand;
  context.subscriptions.push(
    client,
    register("mocc.simulate", onFile("simulate")),
    register("mocc.report", onFile("report")),
    register("mocc.test", () => {
      const terminal = vscode.window.createTerminal("mocc");
      terminal.show(true);
      terminal.sendText(`${program()} test`);
    }),
  );
  return client.start();
}

function deactivate() {
  return client?.stop();
}

module.exports = { activate, deactivate };
