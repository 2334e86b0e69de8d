#!/bin/sh
# Makes mocc.vsix. Needs node with npm, zip, and an index of packages for the client of the protocol.
set -eu
cd "$(dirname "$0")"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/extension"
cp -r package.json extension.js language-configuration.json syntaxes README.md "$work/extension/"
cp ../../LICENSE-MIT "$work/extension/LICENSE.txt"
(cd "$work/extension" && npm install --silent --no-audit --no-fund --no-save vscode-languageclient@9)
version=$(sed -n 's/.*"version": "\(.*\)",/\1/p' package.json | head -n 1)
cat > "$work/extension.vsixmanifest" <<XML
<?xml version="1.0" encoding="utf-8"?>
<PackageManifest Version="2.0.0" xmlns="http://schemas.microsoft.com/developer/vsx-schema/2011">
  <Metadata>
    <Identity Language="en-US" Id="mocc" Version="$version" Publisher="mocc"/>
    <DisplayName>mocc</DisplayName>
    <Description xml:space="preserve">Modelica with mocc</Description>
    <Properties>
      <Property Id="Microsoft.VisualStudio.Code.Engine" Value="^1.75.0"/>
    </Properties>
  </Metadata>
  <Installation><InstallationTarget Id="Microsoft.VisualStudio.Code"/></Installation>
  <Dependencies/>
  <Assets>
    <Asset Type="Microsoft.VisualStudio.Code.Manifest" Path="extension/package.json" Addressable="true"/>
    <Asset Type="Microsoft.VisualStudio.Services.Content.Details" Path="extension/README.md" Addressable="true"/>
  </Assets>
</PackageManifest>
XML
cat > "$work/[Content_Types].xml" <<XML
<?xml version="1.0" encoding="utf-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
  <Default Extension=".json" ContentType="application/json"/>
  <Default Extension=".js" ContentType="application/javascript"/>
  <Default Extension=".md" ContentType="text/markdown"/>
  <Default Extension=".txt" ContentType="text/plain"/>
  <Default Extension=".vsixmanifest" ContentType="text/xml"/>
</Types>
XML
rm -f mocc.vsix
out=$(pwd)/mocc.vsix
(cd "$work" && zip -qr "$out" '[Content_Types].xml' extension.vsixmanifest extension)
echo "wrote mocc.vsix"
