#!/usr/bin/env bash
# Builds three.bundle.js beside this script; needs node and npm. Run it to move to another version
# of three.js, or when three.entry.js changes, and commit the result.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
three=0.187.0
esbuild=0.28.2
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init --yes >/dev/null
npm install --silent "three@$three" "esbuild@$esbuild"
cp "$here/three.entry.js" .
# The licence travels in the bundle, and so in every report.
banner="/* three.js $three
$(cat node_modules/three/LICENSE)
*/"
npx esbuild three.entry.js --bundle --minify --format=iife --global-name=THREE \
  --legal-comments=none --banner:js="$banner" --outfile="$here/three.bundle.js"
