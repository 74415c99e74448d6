// A studio of one's own, and a browser before it.

import { spawn } from 'node:child_process';
import { chromium } from 'playwright-core';

export const program = process.env.NUNO_PROGRAM;
export const patience = 120_000; // for a machine that has other work
// WebGL without a graphics card: arguments for the browser.
export const webgl_in_software = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

// `more` are arguments for the browser.
export async function start_studio(more = []) {
  const server = spawn(program, ['studio', '--no-open', '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  const url = await new Promise((resolve, reject) => {
    let said = '';
    server.stdout.on('data', (data) => {
      said += data;
      const found = said.match(/http:\/\/127\.0\.0\.1:\d+\//);
      if (found) resolve(found[0]);
    });
    server.on('exit', () => reject(new Error(`the studio ended: ${said}`)));
  });
  const browser = await chromium.launch({
    executablePath: '/usr/bin/chromium',
    args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-background-networking', ...more],
  });
  const end = async () => {
    await browser.close();
    server.kill('SIGINT');
  };
  return { url, browser, end };
}

// A page of its own before a studio, once it is ready; its errors are added to `page_errors`.
export async function open_page(studio, options, page_errors) {
  const context = await studio.browser.newContext({ acceptDownloads: true, ...options });
  const made = await context.newPage();
  made.setDefaultTimeout(patience);
  made.on('pageerror', (error) => page_errors.push(error.message));
  await made.goto(studio.url);
  return made;
}
