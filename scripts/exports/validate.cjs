// Khronos' validator on each file named: fails on errors and warnings, counts what is merely noted.
const fs = require("fs");
const validator = require("gltf-validator");

async function main() {
  const noted = new Map();
  let bad = 0;
  for (const path of process.argv.slice(2)) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(path)), { maxIssues: 1000 });
    const { numErrors, numWarnings, messages } = report.issues;
    for (const message of messages) {
      if (message.severity <= 1) console.error(`${path}: ${message.code} at ${message.pointer}: ${message.message}`);
      else noted.set(message.code, (noted.get(message.code) || 0) + 1);
    }
    if (numErrors + numWarnings > 0) bad += 1;
  }
  const notes = [...noted].map(([code, times]) => `${code} ${times} times`).join(", ") || "nothing";
  console.log(`${process.argv.length - 2} files, ${bad} with errors or warnings; noted: ${notes}`);
  if (bad > 0 || process.argv.length < 3) process.exit(1);
}

main().catch((error) => { console.error(error); process.exit(1); });
