// The rooms with content, as users see them.

/** The example of a flight, with its report. */
export async function flight(page) {
  await page.getByRole('button', { name: 'Try an example' }).click();
  await page.locator('.report output').first().waitFor({ timeout: 60_000 });
  await page.locator('.fired li').first().waitFor({ state: 'attached' });
}

/** A rule set with its map, its terms and an explanation. */
export async function rules(page) {
  await page.locator('.shapes svg').first().waitFor({ timeout: 60_000 });
  await page.locator('.why').filter({ hasText: /\d/ }).waitFor();
}
