// Connects Visual Studio Code with `mocc lsp`. The protocol's client is that of `vscode-languageclient`, which the
// packaging script adds.
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function program() {
  return vscode.workspace.getConfiguration("mocc").get("path", "mocc");
}

// Runs a command of mocc in a terminal: on the file and the model of a lens, or on the file of the active editor.
function onFile(command) {
  return async (file, model) => {
    const editor = vscode.window.activeTextEditor;
    if (!editor) {
      return;
    }
    await editor.document.save();
    const path = typeof file === "string" ? file : editor.document.uri.fsPath;
    const name = typeof model === "string" ? ` --model "${model}"` : "";
    const terminal = vscode.window.terminals.find((t) => t.name === "mocc") ?? vscode.window.createTerminal("mocc");
    terminal.show(true);
    terminal.sendText(`${program()} ${command} "${path}"${name}`);
  };
}

function activate(context) {
  const server = { command: program(), args: ["lsp"] };
  client = new LanguageClient("mocc", "mocc", server, {
    documentSelector: [{ language: "modelica" }, { scheme: "file", pattern: "**/*.toml" }],
    synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{mo,mol,toml}") },
  });
  const register = vscode.commands.registerCommand;
  context.subscriptions.push(
    client,
    register("mocc.simulate", onFile("simulate")),
    register("mocc.report", onFile("report")),
    register("mocc.check", onFile("check")),
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
