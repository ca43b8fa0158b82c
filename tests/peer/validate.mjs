// Prints what the Khronos glTF validator says of files, as JSON: path -> {errors: [code, pointer, message]...}.
//
//   node tests/peer/validate.mjs FOLDER_OF_NODE_MODULES FILE...
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [home, ...files] = process.argv.slice(2);
const { validateBytes } = createRequire(path.resolve(home, "package.json"))("gltf-validator");
const ERROR = 0;

async function judge(file) {
  const read = (uri) => new Uint8Array(readFileSync(path.join(path.dirname(file), decodeURIComponent(uri))));
  try {
    const report = await validateBytes(new Uint8Array(readFileSync(file)), {
      uri: path.basename(file),
      maxIssues: 1000,
      externalResourceFunction: async (uri) => read(uri),
    });
    const errors = report.issues.messages.filter((m) => m.severity === ERROR);
    return { errors: errors.map((m) => [m.code, m.pointer ?? "", m.message]) };
  } catch (error) {
    return { errors: [["NOT_GLTF_2", "", String(error)]] }; // Not JSON, or of another version.
  }
}

const verdicts = {};
for (const file of files) verdicts[file] = await judge(file);
console.log(JSON.stringify(verdicts));
