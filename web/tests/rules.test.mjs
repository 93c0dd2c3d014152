// The rules room in Chromium, under the policy of the page.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createServer } from 'node:http';
import { readFile, readdir } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { opened, repository, tab } from './page.mjs';

const read = (path) => readFile(join(repository, path), 'utf8');
const desktop = { viewport: { width: 1280, height: 1400 } };

const { chromium, server } = await opened();

/** Opens the room. It is closed at the end of the test, which fails if the page reported errors or warnings. */
async function room(t, query = '', options = desktop, address = server.address) {
  const opened = await tab(chromium, `${address}#/rules${query}`, options);
  await opened.page.locator('.explanation .value').first().waitFor();
  t.after(async () => {
    await opened.context.close();
    assert.deepEqual(opened.complaints, []);
  });
  return opened;
}

/** The editor's text, as stored in the browser. */
const text = (page) => page.evaluate(() => localStorage.getItem('flagred.rules'));

/** Opens a text as a file. */
const put = (page, content, name = 'rules.yaml') =>
  page.getByLabel('Rule set', { exact: true }).and(page.locator('input')).setInputFiles({ name, mimeType: 'text/plain', buffer: Buffer.from(content) });

/** Replaces the text of the editor by pasting another. */
async function paste(page, content) {
  await page.locator('.cm-content').focus();
  await page.keyboard.press('Control+a');
  await page.locator('.cm-content').evaluate((element, content) => {
    const clipboardData = new DataTransfer();
    clipboardData.setData('text/plain', content);
    element.dispatchEvent(new ClipboardEvent('paste', { clipboardData, bubbles: true, cancelable: true, composed: true }));
  }, content);
}

const problems = (page) => page.locator('.problems .count');

/** Selects a text in the editor, as a double click does, and types another. */
async function retype(page, old, typed) {
  await page.locator('.cm-content').focus();
  await page.keyboard.press('Control+f');
  await page.keyboard.type(old);
  await page.keyboard.press('Enter');
  await page.keyboard.press('Escape');
  await page.keyboard.type(typed);
}

test('a mistake is marked during typing, and listed', async (t) => {
  const { page } = await room(t, '?start=flagred-paper');
  await retype(page, 'IF margin', 'IF margn');
  await page.locator('.problems li', { hasText: 'margn' }).first().waitFor();
  assert.match(await problems(page).textContent(), /error/);
  await page.locator('.cm-lintRange-error').first().waitFor();
  await page.locator('.stale').waitFor();
  await page.locator('.problems li button').first().click();
  assert.match(await page.evaluate(() => document.querySelector('.editor').shadowRoot.getSelection?.().toString() ?? 'margn'), /margn/);
  await page.keyboard.type('margin');
  await page.waitForFunction(() => !document.querySelector('.problems .count').textContent.includes('error'));
  await page.locator('.stale').waitFor({ state: 'hidden' });
});

test('completions are offered, and a hover explains a name', async (t) => {
  const { page } = await room(t, '?start=tipper');
  await retype(page, 'IS good', 'IS ');
  await page.keyboard.press('Control+Space');
  const offered = page.locator('.cm-tooltip-autocomplete');
  await offered.getByText('excellent').waitFor();
  assert.deepEqual((await offered.locator('.cm-completionLabel').allTextContents()).slice(0, 3), ['poor', 'good', 'excellent']);
  await page.keyboard.press('Escape');
  await page.keyboard.type('good');
  await page.locator('.cm-line', { hasText: 'IF service IS good' }).getByText('IF service IS good').hover({ position: { x: 80, y: 8 } });
  await page.locator('.cm-hover', { hasText: 'How the guest rates the service' }).waitFor();
});

test('for every wrong rule set the message is shown, and the page continues', async (t) => {
  const { page } = await room(t);
  const folder = 'tests/authoring/err';
  const files = (await readdir(join(repository, folder))).filter((name) => name.endsWith('.yaml'));
  assert.ok(files.length >= 107);
  const command = join(repository, 'target/debug/flagred');
  const said = (() => {
    try {
      return execFileSync(command, ['check', '--json', ...files.map((file) => `${folder}/${file}`)], { cwd: repository, encoding: 'utf8', stdio: 'pipe' });
    } catch (error) {
      return error.stdout;
    }
  })();
  const known = said.split(/\n(?=\{)/).map((document) => JSON.parse(document));
  assert.equal(known.length, files.length);
  for (const { file, findings } of known) {
    await paste(page, await read(file));
    const [first] = findings.filter(({ severity }) => severity === 'error');
    assert.ok(first, file);
    await page.waitForFunction(
      ([messages]) => JSON.stringify([...document.querySelectorAll('.problems li > button:first-child')].map((item) => messages.find((message) => item.textContent.includes(message)))) === JSON.stringify(messages),
      [findings.map(({ message }) => message)],
      { timeout: 10_000 },
    ).catch(() => assert.fail(`${file}: ${first.message}`));
  }
  // The page still works.
  await paste(page, await read('crates/authoring/src/starter.yaml'));
  await page.waitForFunction(() => document.querySelector('.problems .count').textContent === 'no findings');
});

test('dragging a term changes only its numbers, as one step for undo', async (t) => {
  const { page } = await room(t, '?start=tipper');
  const before = await read('rules/tipper.yaml');
  const handle = page.getByRole('slider', { name: 'good: mean' });
  const box = await handle.boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const drawn = () => page.locator('canvas.decision').evaluate((canvas) => canvas.toDataURL());
  const old = await drawn();
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 10; i++) await page.mouse.move(x + 4 * i, y - i);
  await page.mouse.up();
  await page.waitForFunction((before) => (localStorage.getItem('flagred.rules') ?? before) !== before, before);
  const after = await text(page);
  const [, mean] = /good: \{gaussian: \{mean: ([\d.]+), sd: 1.5\}\}/.exec(after);
  assert.ok(Number(mean) > 5.5, mean);
  const moved = await handle.locator('.dot').boundingBox();
  assert.ok(Math.abs(moved.x + moved.width / 2 - (x + 40)) < 1.5, 'the point is under the pointer');
  assert.equal(after, before.replace('mean: 5,', `mean: ${mean},`));
  assert.notEqual(await drawn(), old, 'the map follows');
  await page.getByRole('button', { name: 'Undo' }).click();
  await page.waitForFunction((before) => localStorage.getItem('flagred.rules') === before, before);
  assert.ok(await page.getByRole('button', { name: 'Undo' }).isDisabled());
  await page.getByRole('button', { name: 'Redo' }).click();
  await page.waitForFunction((after) => localStorage.getItem('flagred.rules') === after, after);
});

test('a point of a term moves by keys, and a comment stays', async (t) => {
  const { page } = await room(t, '?start=my-rules');
  await page.getByRole('slider', { name: 'dry: top' }).focus();
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(() => localStorage.getItem('flagred.rules')?.includes('left_shoulder: [40.4, 60]}'));
  await page.waitForFunction(() => location.hash.includes('?') && !location.hash.includes('start='));
  assert.match(await text(page), /dry: \{left_shoulder: \[40\.4, 60\]\} # 1 up to 40, 0 from 60 on/);
});

test('a click on the map is explained as in the command line', async (t) => {
  const { page } = await room(t, '?start=flagred-paper');
  const box = await page.locator('canvas.decision').boundingBox();
  await page.mouse.click(box.x + box.width * 0.3, box.y + box.height * 0.4);
  const explained = async () => {
    await page.waitForTimeout(500);
    const values = await page.locator('.input input[type=range]').evaluateAll((all) => all.map((one) => one.value));
    const at = new URLSearchParams((await page.evaluate(() => location.hash)).split('?')[1]).get('at').split(',');
    const said = execFileSync(
      join(repository, 'target/debug/flagred'),
      ['explain', '--json', 'rules/flagred-paper.yaml', `margin=${at[0]}`, `spread=${at[1]}`],
      { cwd: repository, encoding: 'utf8' },
    );
    const { rules, outputs } = JSON.parse(said);
    assert.deepEqual(await page.locator('.fired code').allTextContents(), rules.map(({ text }) => text));
    assert.deepEqual(
      await page.locator('.fired li').evaluateAll((all) => all.map((one) => one.value)),
      rules.map(({ rule }) => rule),
    );
    const shown = await page.locator('.fired .strength').allTextContents();
    shown.forEach((strength, i) => assert.ok(Math.abs(Number(strength) - rules[i].strength) < 1e-3, strength));
    if (outputs[0].value !== null) assert.ok(Math.abs(parseFloat(await page.locator('.value b').textContent()) - outputs[0].value) < 0.1);
    return values;
  };
  const clicked = await explained();
  await page.locator('canvas.decision').focus();
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowUp');
  const moved = await explained();
  assert.ok(Number(moved[0]) > Number(clicked[0]) && Number(moved[1]) > Number(clicked[1]));
});

test('held inputs, axes and pictures can be chosen, and the address contains them', async (t) => {
  const { page, context } = await room(t, '?start=flagred&x=unsteady_lately&y=throttle_activity&show=surface');
  assert.equal(await page.getByLabel('Input across').inputValue(), 'unsteady_lately');
  assert.equal(await page.getByLabel('Show').inputValue(), 'surface');
  await page.getByLabel('Show').selectOption('rules');
  await page.locator('.legend.rules li').first().waitFor();
  await page.getByLabel('Input up').selectOption('swing_per_room');
  await page.getByLabel('at_limit, as a number').fill('0.25');
  await page.getByLabel('at_limit, as a number').press('Enter');
  await page.waitForFunction(() => location.hash.includes('y=swing_per_room') && location.hash.includes('0.25'));
  const link = page.url();
  const other = await context.newPage();
  await other.goto(link);
  await other.locator('.legend.rules li').first().waitFor();
  assert.equal(await other.getByLabel('at_limit, as a number').inputValue(), '0.25');
  assert.equal(await other.getByLabel('Input up').inputValue(), 'swing_per_room');
  // Another address in the same page.
  await other.evaluate(() => (location.hash = '#/rules?start=flagred-paper&x=spread&y=margin&at=0.125,0.25'));
  await other.waitForFunction(() => document.querySelector('[aria-label="margin, as a number"]')?.value === '0.125');
  assert.equal(await other.getByLabel('Input across').inputValue(), 'spread');
});

test('a link contains the rule set', async (t) => {
  const { page } = await room(t, '?start=tipper');
  const edited = `${await read('rules/tipper.yaml')}# äöü 𝛼 <b>\n`;
  await put(page, edited);
  await page.waitForFunction((text) => localStorage.getItem('flagred.rules') === text, edited);
  await page.getByRole('button', { name: 'Copy link' }).click();
  await page.waitForFunction(() => location.hash.includes('text='));
  const { page: other } = await room(t, page.url().slice(page.url().indexOf('?')));
  await other.getByLabel('service, as a number').waitFor();
  await other.locator('.cm-content').focus();
  await other.keyboard.press('Control+End');
  await other.keyboard.type('#');
  await other.waitForFunction((text) => localStorage.getItem('flagred.rules') === `${text}#`, edited);
  const { page: damaged } = await room(t, '?text=AAAA');
  await damaged.getByText('The link is damaged').waitFor();
});

test('the text is restored after a reload; a browser that stores nothing is reported', async (t) => {
  const { page } = await room(t);
  await put(page, (await read('rules/tipper.yaml')).replace('name: tipper', 'name: mine'));
  await page.waitForFunction(() => localStorage.getItem('flagred.rules')?.includes('name: mine'));
  await page.goto(`${server.address}`);
  await page.goto(`${server.address}#/rules`);
  await page.locator('.cm-line', { hasText: 'name: mine' }).waitFor();

  const { page: other } = await room(t);
  await other.evaluate(() => {
    Storage.prototype.setItem = () => {
      throw new DOMException('full', 'QuotaExceededError');
    };
  });
  await put(other, await read('rules/tipper.yaml'));
  await other.getByText('This browser cannot store the rule set').waitFor();
});

test('a link or an example does not discard the user\'s own text', async (t) => {
  const { page } = await room(t);
  const mine = (await read('rules/tipper.yaml')).replace('name: tipper', 'name: mine');
  await paste(page, mine);
  await page.waitForFunction((mine) => localStorage.getItem('flagred.rules') === mine, mine);
  await page.goto(server.address);
  await page.goto(`${server.address}#/rules?start=flagred-paper`);
  await page.getByLabel('margin, as a number').waitFor();
  await page.locator('.cm-content').focus();
  await page.keyboard.type('# ');
  await page.waitForFunction((mine) => localStorage.getItem('flagred.rules') !== mine, mine);
  await page.getByLabel('Start from').selectOption('before');
  await page.locator('.cm-line', { hasText: 'name: mine' }).waitFor();
  await page.waitForFunction((mine) => localStorage.getItem('flagred.rules') === mine, mine);
});

test('the rule viewer shows all rules with their degrees, and changes with the point', async (t) => {
  const { page } = await room(t, '?start=tipper');
  const viewer = page.locator('.viewer');
  await viewer.locator('tbody tr').nth(2).waitFor();
  assert.equal(await viewer.locator('tbody tr').count(), 3);
  const cells = () => viewer.locator('tbody tr').first().locator('.part').evaluateAll((all) => all.map((one) => [one.textContent, one.querySelector('.cut').getAttribute('d')]));
  await page.getByLabel('food, as a number').fill('2');
  await page.getByLabel('food, as a number').press('Enter');
  await viewer.getByText('rancid 0.5').waitFor();
  const first = await cells();
  assert.deepEqual(first.map(([words]) => words), ['poor 0.004', 'rancid 0.5', 'cheap 0.5']);
  assert.ok(first[2][1].length > 10, 'the consequent is cut');
  assert.equal(await viewer.locator('tbody tr').first().locator('.strength').textContent(), '0.500');
  assert.match(await viewer.locator('tfoot').textContent(), /\d %/);
  // Dragging the line of an input changes the point.
  const box = await viewer.locator('tbody tr').first().locator('svg.moves').nth(1).boundingBox();
  await page.mouse.click(box.x + box.width * 0.9, box.y + box.height / 2);
  await viewer.getByText('rancid 0', { exact: true }).waitFor();
  assert.ok(Math.abs(Number(await page.getByLabel('food, as a number').inputValue()) - 9) < 0.2);
});

test('a surface turns by drag and keys, and turns back', async (t) => {
  const { page } = await room(t, '?start=tipper&show=surface');
  const drawn = () => page.locator('canvas.decision').evaluate((canvas) => canvas.toDataURL());
  await page.waitForTimeout(300);
  const front = await drawn();
  const at = await page.getByLabel('service, as a number').inputValue();
  const box = await page.locator('canvas.decision').boundingBox();
  await page.mouse.move(box.x + 200, box.y + 150);
  await page.mouse.down();
  await page.mouse.move(box.x + 280, box.y + 170, { steps: 4 });
  await page.mouse.up();
  await page.waitForTimeout(100);
  const turned = await drawn();
  assert.notEqual(turned, front);
  await page.locator('canvas.decision').focus();
  await page.keyboard.press('ArrowLeft');
  await page.waitForTimeout(100);
  assert.notEqual(await drawn(), turned);
  assert.equal(await page.getByLabel('service, as a number').inputValue(), at, 'the point stays');
  await page.locator('canvas.decision').dblclick();
  await page.waitForTimeout(100);
  assert.equal(await drawn(), front);
});

test('everything that is shown belongs to the open text', async (t) => {
  const { page } = await room(t, '?start=tipper&x=food&y=service');
  // The line in the picture of a term is at the current point, also after Undo.
  await page.getByRole('slider', { name: 'good: mean' }).focus();
  await page.keyboard.press('ArrowRight');
  await page.locator('.variable output', { hasText: 'good: mean 5.1' }).waitFor();
  await page.getByRole('button', { name: 'Undo' }).click();
  await page.locator('.variable output', { hasText: /^good: mean 5$/ }).waitFor();
  // A number that was deleted is restored.
  await page.getByLabel('food, as a number').fill('');
  await page.getByLabel('service, as a number').focus();
  assert.equal(await page.getByLabel('food, as a number').inputValue(), '5');
  // Another rule set with the same inputs starts with its own axes.
  await put(page, (await read('rules/tipper.yaml')).replace('name: tipper', 'name: other'));
  await page.getByRole('heading', { name: 'other' }).waitFor();
  assert.equal(await page.getByLabel('Input across').inputValue(), 'service');
  // A value outside the shown part switches the slider to the whole range, instead of being shown at the end of the
  // part.
  const { page: flight } = await room(t, '?start=flagred-paper&at=0.25,0.25');
  const slider = flight.getByRole('slider', { name: 'spread' });
  await flight.waitForFunction(() => document.querySelector('[aria-label="spread, as a number"]').value === '0.25');
  assert.ok(Number(await slider.getAttribute('max')) > 0.25);
});

test('a file that cannot be read is not offered for reading with losses', async (t) => {
  const { page } = await room(t);
  const fis = "[System]\nName='x'\nType='mamdani'\nNumInputs=1\nNumOutputs=1\nNumRules=0\n[Input1]\nName='a'\nRange=[0 x]\nNumMFs=0\n[Output1]\nName='b'\nRange=[0 1]\nNumMFs=0\n[Rules]\n";
  await put(page, fis, 'broken.fis');
  const dialog = page.getByRole('dialog');
  await dialog.getByRole('heading', { name: 'Open broken.fis' }).waitFor();
  assert.deepEqual(await dialog.getByRole('button').allTextContents(), ['Close']);
  assert.doesNotMatch(await dialog.textContent(), /\\u\{a\}/);
  assert.ok((await dialog.getByRole('listitem').count()) > 0);
});

test('files in other formats are opened by drop and by button, and are written', async (t) => {
  const { page } = await room(t);
  const fis = execFileSync(join(repository, 'target/debug/flagred'), ['export', '--fis', '--lossy', 'rules/tipper.yaml'], {
    cwd: repository, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'],
  });
  await put(page, fis, 'tipper.fis');
  const dialog = page.getByRole('dialog');
  await dialog.getByRole('heading', { name: 'tipper.fis was read as FIS' }).waitFor();
  await dialog.getByRole('button', { name: 'Close' }).click();
  await page.locator('.cm-line', { hasText: 'fuzzy: 1' }).waitFor();
  await page.getByLabel('service, as a number').waitFor();

  const dropped = await page.evaluateHandle((content) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([content], 'dropped.yaml'));
    return transfer;
  }, await read('rules/flagred-paper.yaml'));
  await page.dispatchEvent('.room.rules .editor', 'drop', { dataTransfer: dropped });
  await page.getByLabel('margin, as a number').waitFor();

  const down = page.waitForEvent('download');
  await page.getByLabel('Download').selectOption('FLL');
  const leave = page.getByRole('button', { name: 'Leave it out and continue' });
  const which = await Promise.race([down.then(() => 'down'), leave.waitFor().then(() => 'asked')]);
  if (which === 'asked') await leave.click();
  const file = await down;
  assert.equal(file.suggestedFilename(), 'flagred-paper.fll');
  assert.match(await readFile(await file.path(), 'utf8'), /^Engine: /m);

  await page.getByRole('dialog').getByRole('button', { name: 'Close' }).click({ timeout: 2000 }).catch(() => undefined);
  const picture = page.waitForEvent('download');
  await page.getByLabel('Download').selectOption('map');
  assert.match(await readFile(await (await picture).path(), 'utf8'), /^<svg /);

  await put(page, '\u0000\u0001'.repeat(10), 'x.bin');
  await page.waitForFunction(() => document.querySelector('.problems .count').textContent.includes('error'));
});

test('a profile is checked too', async (t) => {
  const { page } = await room(t, '?start=my-profile');
  assert.doesNotMatch(await problems(page).textContent(), /error/);
  await retype(page, 'mean: motor_command', 'mean: motor_comand');
  await page.locator('.problems li', { hasText: 'motor_comand' }).first().waitFor();
});

test('nothing in a rule set is markup', async (t) => {
  const { page } = await room(t);
  const evil = '<img src=x onerror=alert(1)>';
  await put(
    page,
    `fuzzy: 1\nname: "${evil}"\ninputs:\n  heat: {range: [0, 1], unit: "${evil}", description: "${evil}", partition: {"${evil}": 0, b: 1}}\n` +
      `outputs: {speed: {range: [0, 1], partition: [slow, fast]}}\nrules:\n  - IF heat IS '${evil}' THEN speed IS slow\n  - IF heat IS b THEN speed IS "${evil}"\n`,
  );
  await page.locator('.problems li', { hasText: evil }).first().waitFor();
  assert.equal(await page.locator('img').count(), 0);
});

test('a bug is reported and the page continues', async (t) => {
  const { page, complaints } = await room(t);
  // A worker that crashes at one text.
  await page.evaluate(() => {
    const send = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (message, ...rest) {
      if (message?.args?.[0]?.includes?.('name: trap')) {
        this.onmessage({ data: { id: message.id, trapped: 'index out of bounds' } });
        return;
      }
      send.call(this, message, ...rest);
    };
  });
  const tipper = await read('rules/tipper.yaml');
  await paste(page, tipper.replace('name: tipper', 'name: trap'));
  await page.getByText('flagred has a defect, but continues: index out of bounds').waitFor();
  await paste(page, tipper);
  await page.getByLabel('service, as a number').waitFor();
  assert.deepEqual(complaints, []);
});

/** Serves the page as `flagred studio FILE` does: a single file, and the text of a file on disk. */
async function studio(t, { readOnly = false } = {}) {
  const html = await readFile(join(repository, 'crates/cli/page/studio.html'));
  const disk = { text: await read('rules/tipper.yaml'), version: 1 };
  const made = createServer((request, response) => {
    if (request.url !== '/api/file') return response.writeHead(200, { 'Content-Type': 'text/html' }).end(html);
    const tag = () => `"${disk.version}"`;
    if (request.method === 'GET') {
      response.writeHead(200, { ETag: tag(), 'X-File-Name': 'my%20rules.yaml', 'X-Read-Only': String(readOnly) });
      return response.end(disk.text);
    }
    let body = '';
    request.on('data', (part) => (body += part));
    request.on('end', () => {
      if (request.headers['if-match'] !== tag()) return response.writeHead(412).end('the file changed on disk');
      Object.assign(disk, { text: body, version: disk.version + 1 });
      response.writeHead(204, { ETag: tag() }).end();
    });
  });
  await new Promise((resolve) => made.listen(0, '127.0.0.1', resolve));
  t.after(() => (made.closeAllConnections(), made.close()));
  return { disk, address: `http://127.0.0.1:${made.address().port}/` };
}

test('a file on disk is saved, and changes by another program are not lost', async (t) => {
  const { disk, address } = await studio(t);
  const { page } = await room(t, '', desktop, address);
  const state = page.locator('.backing [role=status]');
  await page.getByText('my rules.yaml', { exact: true }).waitFor();
  assert.equal(await state.textContent(), 'saved');
  await page.locator('.cm-content').focus();
  await page.keyboard.press('Control+End');
  await page.keyboard.type('# mine');
  assert.equal(await state.textContent(), 'changed');
  await page.keyboard.press('Control+s');
  await page.getByText('my rules.yaml is saved').waitFor();
  assert.ok(disk.text.endsWith('# mine'));
  assert.equal(await state.textContent(), 'saved');

  // After a change by another program, the file is read again if nothing is lost; otherwise the user is asked.
  Object.assign(disk, { text: disk.text.replace('name: tipper', 'name: theirs'), version: 9 });
  await page.locator('.cm-line', { hasText: 'name: theirs' }).waitFor();
  await page.keyboard.type('!');
  Object.assign(disk, { text: `${disk.text}\n# theirs`, version: 10 });
  await page.locator('.changed-on-disk').waitFor();
  await page.keyboard.press('Control+s');
  assert.ok(disk.text.endsWith('# theirs'));
  await page.getByRole('button', { name: 'Keep mine' }).click();
  await page.getByRole('button', { name: 'Save', exact: true }).click();
  await page.waitForFunction(() => document.querySelector('.backing [role=status]').textContent === 'saved');
  assert.ok(!disk.text.includes('# theirs'));
});

test('a read-only file is shown and not written', async (t) => {
  const { disk, address } = await studio(t, { readOnly: true });
  const before = disk.text;
  const { page } = await room(t, '', desktop, address);
  assert.equal(await page.locator('.backing [role=status]').textContent(), 'read-only');
  await page.locator('.cm-content').focus();
  await page.keyboard.type('x');
  await page.keyboard.press('Control+s');
  await page.getByText('is read-only').waitFor();
  assert.equal(disk.text, before);
});

for (const [name, options] of Object.entries({
  desktop,
  phone: { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true },
  dark: { ...desktop, colorScheme: 'dark' },
})) {
  test(`axe finds nothing serious: ${name}`, async (t) => {
    const { page } = await room(t, '?start=flagred-paper', options);
    await retype(page, 'IF margin', 'IF margn');
    await page.locator('.problems li', { hasText: 'margn' }).first().waitFor();
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(wide <= 0, `${wide} px too wide`);
    await page.evaluate(await read('web/node_modules/axe-core/axe.min.js'));
    const { violations } = await page.evaluate(() => window.axe.run());
    const serious = violations.filter(({ impact }) => ['serious', 'critical'].includes(impact));
    assert.deepEqual(serious.map(({ id, nodes }) => [id, nodes.map(({ html, failureSummary }) => `${html} ${failureSummary}`)]), []);
  });
}
