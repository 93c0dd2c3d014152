// Each room with something in it, as its users see it.

export const rooms = {
  /** The example of a flight, with its report. */
  async flight(page) {
    await page.getByRole('button', { name: 'Try an example' }).click();
    await page.locator('.report h1, .report h2').first().waitFor({ timeout: 60_000 });
    await page.locator('.fired').first().waitFor();
  },
  /** A rule set with its map and its terms. */
  async rules(page) {
    await page.locator('.shapes svg').first().waitFor({ timeout: 60_000 });
    await page.locator('.why').filter({ hasText: /\d/ }).waitFor();
  },
};
