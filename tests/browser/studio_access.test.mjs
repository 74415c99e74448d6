// The studio on a phone, from the keyboard and for a screen reader.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { flight_of, new_page, page, page_errors, scene_of, settled } from './studio_page.mjs';

test('a phone has everything within its width', async () => {
  const phone = await new_page({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const [wide, shown] = await phone.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wide <= shown, `${wide} > ${shown}`);
  if (await phone.isVisible('#first')) await phone.tap('#first-done'); // it lies over the stage
  await phone.tap('#engine-box2d');
  await settled(phone);
  assert.equal((await flight_of('box2d', phone)).backend, 'box2d');
  // Beside is one above the other there, and each can be dragged.
  await phone.tap('#engine-side');
  await settled(phone);
  const [height, view_height, view_width, width] = await phone.evaluate(() => {
    const { view } = nuno_studio;
    return [view.height, view.view_height, view.view_width, view.width];
  });
  assert.equal(view_height, height / 2);
  assert.equal(view_width, width);
  await phone.locator('#stage').scrollIntoViewIfNeeded();
  await phone.evaluate(() => scrollTo(0, 0));
  const target = (await scene_of(phone)).target;
  const stage = await phone.locator('#stage').boundingBox();
  const [x, y] = await phone.evaluate(() => nuno_studio.view.to_screen(nuno_studio.app.doc.scene.target[32]));
  await phone.mouse.move(stage.x + x, stage.y + view_height + y);
  await phone.mouse.down();
  await phone.mouse.move(stage.x + x - 20, stage.y + view_height + y - 20, { steps: 4 });
  await phone.mouse.up();
  await settled(phone);
  const moved = (await scene_of(phone)).target;
  assert.ok(moved[0][0] < target[0][0] && moved[0][1] > target[0][1]);
  await phone.context().close();
});

test('every control has a name for a screen reader', async () => {
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, input, select, canvas')]
    .filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length))
    .map((e) => e.outerHTML.slice(0, 80)));
  assert.deepEqual(nameless, []);
});

test('the Tab key comes to every control', async () => {
  for (const card of ['#cloth-card', '#control-card']) await page.click(`${card} summary`);
  const wanted = await page.evaluate(() => {
    const controls = [...document.querySelectorAll('button, input, select, summary, canvas')]
      .filter((e) => e.checkVisibility({ visibilityProperty: true }) && !e.disabled && e.tabIndex >= 0);
    controls.forEach((e, i) => (e.dataset.stop = i));
    return controls.map((e) => e.id || e.textContent.trim() || e.ariaLabel);
  });
  await page.evaluate(() => document.activeElement.blur());
  const met = new Set();
  for (let i = 0; i < 2 * wanted.length; i++) {
    await page.keyboard.press('Tab');
    met.add(Number(await page.evaluate(() => document.activeElement.dataset.stop ?? -1)));
  }
  assert.deepEqual(wanted.filter((_, i) => !met.has(i)), []);
  await page.focus('#export summary');
  await page.keyboard.press('Enter');
  assert.ok(await page.isVisible('#save-film'));
  await page.keyboard.press('Escape');
  assert.ok(await page.isHidden('#save-film'));
});

test('nothing failed on the page', () => assert.deepEqual(page_errors, []));
