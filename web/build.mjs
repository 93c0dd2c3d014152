// Builds the page: target/web/page for a server, and the single file crates/cli/page/studio.html for `flagred studio`.

import { createHash } from 'node:crypto';
import { copyFile, mkdir, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

const here = fileURLToPath(new URL('.', import.meta.url));
const page = fileURLToPath(new URL('../target/web/page/', import.meta.url));
const studio = fileURLToPath(new URL('../crates/cli/page/studio.html', import.meta.url));
const module = (room) => fileURLToPath(new URL(`../bindings/web/js/wasm/${room}_bg.wasm`, import.meta.url));
const rooms = ['flight', 'rules', 'data'];

const common = {
  absWorkingDir: here,
  bundle: true,
  minify: true,
  format: 'esm',
  target: 'es2022',
  legalComments: 'none',
  loader: { '.gz': 'binary' },
  logLevel: 'warning',
  alias: Object.fromEntries(
    [['flagred', 'index'], ...rooms.map((room) => [`flagred/${room}`, room])].map(([name, file]) => [name, fileURLToPath(new URL(`../target/web/package/${file}.js`, import.meta.url))]),
  ),
};

/** The policy that limits what the page may load. It allows `data:` and `blob:` images, which the page creates itself. */
const policy = (scripts, styles, workers) =>
  [
    "default-src 'none'",
    `script-src ${scripts} 'wasm-unsafe-eval'`,
    `style-src ${styles}`,
    "img-src 'self' data: blob:",
    `worker-src ${workers}`,
    "connect-src 'self'",
    "manifest-src 'self'",
    "base-uri 'none'",
    "form-action 'none'",
  ].join(';');

const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;

async function served(template) {
  await rm(page, { recursive: true, force: true });
  await mkdir(page, { recursive: true });
  await build({
    ...common,
    entryPoints: ['src/main.ts', 'src/worker.ts'],
    outdir: page,
    splitting: true,
    chunkNames: 'part-[hash]',
  });
  for (const room of rooms) await copyFile(module(room), `${page}${room}.wasm`);
  for (const file of ['icon.svg', 'manifest.webmanifest']) await copyFile(here + file, page + file);
  await writeFile(`${page}index.html`, template.replace('{policy}', policy("'self'", "'self'", "'self'")));
  const files = await readdir(page);
  const contents = await Promise.all(files.map((file) => readFile(page + file)));
  const version = createHash('sha256');
  for (const content of contents) version.update(content);
  await build({
    ...common,
    entryPoints: ['src/offline.ts'],
    outdir: page,
    define: { FILES: JSON.stringify(['./', ...files]), BUILD: JSON.stringify(version.digest('hex').slice(0, 16)) },
  });
}

/** Writes the whole page as one file. Its policy allows scripts and styles by hash; worker and modules are embedded data. */
async function oneFile(template) {
  const bundled = async (entry, options) => {
    const { outputFiles } = await build({ ...common, entryPoints: [entry], outdir: page, write: false, ...options });
    return (name) => outputFiles.find((file) => file.path.endsWith(name)).text;
  };
  const part = await bundled('src/main.ts');
  // Not every browser runs a worker from a blob as a module, so the worker contains all that it would otherwise load
  // from an address.
  const worker = await bundled('src/worker.ts', { format: 'iife', define: { 'import.meta.url': '""' } });
  // The script must not contain text that ends its own `<script>` element.
  const script = part('main.js').replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
  const style = part('main.css').trim();
  const data = (id, bytes) => `<script type="application/octet-stream" id="${id}">${bytes.toString('base64')}</script>`;
  const modules = await Promise.all(rooms.map((room) => readFile(module(room))));
  const icon = (await readFile(`${here}icon.svg`)).toString('base64');
  const whole = template
    .replace('{policy}', () => policy(hash(script), hash(style), 'blob:'))
    .replace('<link rel="icon" href="icon.svg"', `<link rel="icon" href="data:image/svg+xml;base64,${icon}"`)
    .replace('<link rel="manifest" href="manifest.webmanifest">\n', '')
    .replace('<link rel="stylesheet" href="main.css">', () => `<style>${style}</style>`)
    .replace(
      '<script type="module" src="main.js"></script>',
      () =>
        data('worker.js', Buffer.from(worker('worker.js'))) +
        rooms.map((room, i) => data(`${room}.wasm`, gzipSync(modules[i], { level: 9 }))).join('') +
        `<script type="module">${script}</script>`,
    );
  await writeFile(studio, whole);
}

const template = await readFile(`${here}index.html`, 'utf8');
await served(template);
await oneFile(template);
let first = 0;
for (const file of await readdir(page)) {
  const packed = gzipSync(await readFile(page + file), { level: 9 }).length;
  first += packed;
  console.log(`${String(packed).padStart(9)} bytes gzipped  ${file}`);
}
console.log(`${String(first).padStart(9)} bytes gzipped  in all`);
