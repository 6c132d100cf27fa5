// The Khronos glTF validator over any number of files: no error and no warning.
//
//     node validate.mjs FILE...

import { readFile } from 'node:fs/promises';
import path from 'node:path';
import validator from 'gltf-validator';

const SEVERITY = ['error', 'warning', 'information', 'hint'];
let failed = false;
for (const file of process.argv.slice(2)) {
  const name = path.basename(file);
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: name,
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  const good = numErrors + numWarnings === 0;
  const first = messages.find((m) => m.severity < 2);
  failed ||= !good;
  const counts = `${numInfos} informations, ${numHints} hints`;
  console.log(good
    ? `ok ${name} is valid (${report.info.totalVertexCount} vertices, ${counts})`
    : `FAILED ${name} is valid: ${numErrors} errors, ${numWarnings} warnings; first: ${first.code} ${first.pointer} ${first.message}`);
  const kinds = new Map();
  for (const m of messages) kinds.set(m.code, [m.severity, (kinds.get(m.code)?.[1] ?? 0) + 1]);
  for (const [code, [severity, count]] of kinds) console.log(`   ${count} × ${SEVERITY[severity]} ${code}`);
}
process.exit(failed ? 1 : 0);
