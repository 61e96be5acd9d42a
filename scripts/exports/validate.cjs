// Khronos' validator on each file named: fails on errors and warnings, counts what is merely noted.
const fs = require("fs");
const validator = require("gltf-validator");

async function main() {
  const noted = new Map();
  let bad = 0;
  for (const path of process.argv.slice(2)) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(path)), { maxIssues: 1000 });
    const { messages } = report.issues;
    // Leaves and cards have normal maps and no tangents: readers make them up, as glTF 2.0 says they should.
    const isNoted = (message) => message.severity > 1 || message.code === "MESH_PRIMITIVE_GENERATED_TANGENT_SPACE";
    for (const message of messages) {
      if (!isNoted(message)) console.error(`${path}: ${message.code} at ${message.pointer}: ${message.message}`);
      else noted.set(message.code, (noted.get(message.code) || 0) + 1);
    }
    if (!messages.every(isNoted)) bad += 1;
  }
  const notes = [...noted].map(([code, times]) => `${code} ${times} times`).join(", ") || "nothing";
  console.log(`${process.argv.length - 2} files, ${bad} with errors or warnings; noted: ${notes}`);
  if (bad > 0 || process.argv.length < 3) process.exit(1);
}

main().catch((error) => { console.error(error); process.exit(1); });
