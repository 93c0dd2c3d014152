// The package as users get it: packed, and installed in a separate folder.

import { execFile } from 'node:child_process';
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after } from 'node:test';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';

export const repository = fileURLToPath(new URL('../../../', import.meta.url));
export const run = promisify(execFile);

/**
 * Packs the package and installs it in a folder. Returns the folder, which is removed after the tests of a file, and
 * the packed files.
 */
export async function install() {
  const folder = await mkdtemp(join(tmpdir(), 'flagred-package-'));
  after(() => rm(folder, { recursive: true }));
  const built = join(repository, 'target/web/package');
  const { stdout } = await run('npm', ['pack', '--json', '--pack-destination', folder], { cwd: built });
  const [packed] = JSON.parse(stdout);
  await writeFile(join(folder, 'package.json'), '{"private": true, "type": "module"}');
  await run('npm', ['install', '--offline', '--no-audit', '--no-fund', join(folder, packed.filename)], { cwd: folder });
  return { folder, files: packed.files.map((file) => file.path), bytes: packed.size };
}
