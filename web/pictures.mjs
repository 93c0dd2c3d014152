// Pictures of both rooms, desktop and phone, into a folder: `scripts/pictures page` runs it.

import { join } from 'node:path';
import { browser, serve, tab } from './tests/page.mjs';
import * as rooms from './tests/rooms.mjs';

const [, , folder] = process.argv;
const devices = {
  desktop: { viewport: { width: 1280, height: 1000 }, deviceScaleFactor: 1 },
  phone: { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true },
};

const chromium = await browser();
const server = await serve();
for (const [room, fill] of Object.entries(rooms)) {
  for (const [device, options] of Object.entries(devices)) {
    const { page, context, complaints } = await tab(chromium, `${server.address}#/${room}`, { ...options, reducedMotion: 'reduce' });
    await fill(page);
    if (room === 'rules') {
      const starts = page.getByLabel('Start from an example');
      const tipper = starts.locator('option', { hasText: 'tipper' }).first();
      await starts.selectOption(await tipper.getAttribute('value'));
      await page.locator('.why').filter({ hasText: 'tip' }).waitFor();
      await page.locator('#said').evaluate((said) => (said.textContent = ''));
      if (device === 'phone') await page.locator('.map').evaluate((map) => map.scrollIntoView());
    }
    // Wait until all animations have ended.
    await page.waitForTimeout(1000);
    await page.screenshot({ path: join(folder, `page-${room}-${device}.png`) });
    if (room === 'rules' && device === 'desktop') {
      await page.getByRole('tab', { name: 'Table' }).click();
      await page.locator('.parts').screenshot({ path: join(folder, 'page-rules-table.png') });
    }
    if (complaints.length > 0) throw new Error(complaints.join('\n'));
    await context.close();
  }
}
await chromium.close();
await server.close();
