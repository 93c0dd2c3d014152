// While a term is dragged, the page draws every frame and updates the map.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { isTimed, opened, tab } from './page.mjs';

/** The maximum processor time of a frame at 60 frames a second. */
const FRAME_MS = 1000 / 60;
/** The number of frames that counts as 60 a second, given the error of counting. */
const MIN_FRAMES = 57;
const DRAGGED_S = 2;
const TRIES = 3;

const { chromium, server } = await opened();

/** Drags a point of the first variable to and fro, with one move a frame. */
async function drag(start) {
  const { page, context, complaints } = await tab(chromium, 'about:blank', { viewport: { width: 1280, height: 1400 } });
  await page.addInitScript(() => {
    const put = CanvasRenderingContext2D.prototype.putImageData;
    window.maps = 0;
    CanvasRenderingContext2D.prototype.putImageData = function (...image) {
      window.maps++;
      return put.apply(this, image);
    };
  });
  await page.goto(`${server.address}#/rules?start=${start}`);
  await page.locator('.explanation .value').first().waitFor();
  await page.waitForTimeout(500);
  const handle = page.locator('.variable').first().locator('.handle').nth(1);
  await handle.scrollIntoViewIfNeeded();
  const box = await handle.boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  const session = await context.newCDPSession(page);
  await session.send('Performance.enable', { timeDomain: 'threadTicks' });
  const busy_s = async () => {
    const { metrics } = await session.send('Performance.getMetrics');
    return metrics.find(({ name }) => name === 'TaskDuration').value;
  };
  const before_s = await busy_s();
  const { frames, maps, length_s } = await handle.evaluate(
    (point, [x, y, dragged_s]) =>
      new Promise((done) => {
        const begun = performance.now();
        const maps = window.maps;
        let frames = 0;
        const step = () => {
          const length_s = (performance.now() - begun) / 1000;
          if (length_s > dragged_s) return done({ frames, maps: window.maps - maps, length_s });
          const clientX = x + 30 * Math.sin(frames++ / 20);
          point.dispatchEvent(new PointerEvent('pointermove', { pointerId: 1, clientX, clientY: y, bubbles: true }));
          requestAnimationFrame(step);
        };
        requestAnimationFrame(step);
      }),
    [x, y, DRAGGED_S],
  );
  const frame_ms = ((await busy_s()) - before_s) * (1000 / frames);
  await page.mouse.up();
  assert.deepEqual(complaints, []);
  await context.close();
  return { frames_a_second: frames / length_s, maps_a_second: maps / length_s, frame_ms };
}

for (const start of ['tipper', 'flagred-paper', 'flagred', 'flagred-battery']) {
  test(`a term of ${start} is dragged`, async (told) => {
    const all = [];
    const most = () => Math.max(...all.map(({ frames_a_second }) => frames_a_second));
    while (all.length < TRIES && !(most() >= MIN_FRAMES)) {
      all.push(await drag(start));
      told.diagnostic(JSON.stringify(all.at(-1)));
    }
    assert.ok(!isTimed || most() >= MIN_FRAMES, `${most()} frames a second`);
    assert.ok(!isTimed || Math.min(...all.map(({ frame_ms }) => frame_ms)) < FRAME_MS);
    assert.ok(all.every(({ maps_a_second }) => maps_a_second > 1), 'the map is not updated');
  });
}

/** Turns a surface by a drag, with one move a frame; measures the frames a second, and the processor time of a frame. */
async function turn(start) {
  const { page, context, complaints } = await tab(chromium, `${server.address}#/rules?start=${start}&show=surface`, { viewport: { width: 1280, height: 1400 } });
  await page.locator('.explanation .value').first().waitFor();
  await page.waitForTimeout(500);
  const canvas = page.locator('canvas.decision');
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + 200, box.y + 150);
  await page.mouse.down();
  const session = await context.newCDPSession(page);
  await session.send('Performance.enable', { timeDomain: 'threadTicks' });
  const busy_s = async () => {
    const { metrics } = await session.send('Performance.getMetrics');
    return metrics.find(({ name }) => name === 'TaskDuration').value;
  };
  const before_s = await busy_s();
  const { frames, length_s, pictures } = await canvas.evaluate(
    (canvas, turned_s) =>
      new Promise((done) => {
        const begun = performance.now();
        let frames = 0;
        const pictures = new Set();
        const step = () => {
          const length_s = (performance.now() - begun) / 1000;
          if (length_s > turned_s) return done({ frames, length_s, pictures: pictures.size });
          if (frames % 40 === 0) pictures.add(canvas.toDataURL());
          frames++;
          canvas.dispatchEvent(new PointerEvent('pointermove', { pointerId: 1, movementX: 3, movementY: frames % 60 < 30 ? 1 : -1, bubbles: true }));
          requestAnimationFrame(step);
        };
        requestAnimationFrame(step);
      }),
    DRAGGED_S,
  );
  const frame_ms = ((await busy_s()) - before_s) * (1000 / frames);
  await page.mouse.up();
  assert.deepEqual(complaints, []);
  await context.close();
  return { frames_a_second: frames / length_s, frame_ms, pictures };
}

for (const start of ['tipper', 'flagred']) {
  test(`the surface of ${start} turns`, async (told) => {
    const all = [];
    const most = () => Math.max(...all.map(({ frames_a_second }) => frames_a_second));
    while (all.length < TRIES && !(most() >= MIN_FRAMES)) {
      all.push(await turn(start));
      told.diagnostic(JSON.stringify(all.at(-1)));
    }
    assert.ok(!isTimed || most() >= MIN_FRAMES, `${most()} frames a second`);
    assert.ok(!isTimed || Math.min(...all.map(({ frame_ms }) => frame_ms)) < FRAME_MS);
    assert.ok(all.every(({ pictures }) => pictures > 1), 'the surface does not turn');
  });
}
