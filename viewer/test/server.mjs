// What the server must not do.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import http from 'node:http';
import net from 'node:net';
import os from 'node:os';
import { assertNear, rowOf, withPage } from './browser.mjs';

/** Serves things; `check` gets the server's address. */
async function withServer(things, check) {
  const server = spawn(process.env.E2LF, ['view', ...things, '--json']);
  let text = '';
  const address = await new Promise((resolve, reject) => {
    server.stdout.on('data', (data) => { text += data; if (text.includes('\n')) resolve(JSON.parse(text).url); });
    server.on('exit', (code) => reject(new Error(`the server ended with ${code}`)));
  });
  const ended = new Promise((resolve) => server.on('exit', resolve));
  try {
    await check(new URL(address));
  } finally {
    server.kill('SIGINT');
  }
  assert.equal(await ended, 130, 'Ctrl-C ends it');
}

/** The status and the text for a path as it stands, which no URL parser has touched. */
function ask(address, path, headers = {}, method = 'GET', setHost = true) {
  return new Promise((resolve, reject) => {
    const request = http.request({ host: '127.0.0.1', port: address.port, path, method, headers, setHost }, (answer) => {
      let text = '';
      answer.on('data', (data) => (text += data));
      answer.on('end', () => resolve({ status: answer.statusCode, text, headers: answer.headers }));
    });
    request.on('error', reject);
    request.end();
  });
}

function refusesConnections(host, port) {
  return new Promise((resolve) => {
    const socket = net.connect({ host, port, timeout: 3000 });
    socket.on('connect', () => { socket.destroy(); resolve(false); });
    socket.on('error', () => resolve(true));
    socket.on('timeout', () => { socket.destroy(); resolve(true); });
  });
}

export const tests = {
  'a served page shows what an exported one shows': ({ expected }) => withServer(['light.npy'], (address) =>
    withPage(`${address}#x=0.5&y=0.5`, {}, async (page) => assertNear(await rowOf(page, 'canvas.picture', 20), expected.views[4][4], 0, 'view 4, 4'))),

  'nothing but the page, its description and its parts': () => withServer(['linked'], async (address) => {
    const secret = address.pathname;
    assert.equal((await ask(address, secret)).status, 200);
    assert.equal((await ask(address, `${secret}document.json`)).status, 200);
    assert.equal((await ask(address, `${secret}part/0`)).status, 200);
    const others = ['part/64', 'part/-1', 'part/0x0', 'part/1e0', 'part/', 'part/0/', 'light.npy', 'linked/secret.txt', 'secret.txt', 'part/../secret.txt',
      '../../../../../../etc/passwd', '..%2f..%2f..%2fetc/passwd', '%2e%2e/%2e%2e/etc/passwd', 'part/%00', '//etc/passwd', '....//etc/passwd'];
    for (const path of others) {
      const { status, text } = await ask(address, secret + path);
      assert.equal(status, 404, path);
      assert.ok(!text.includes('root:') && !text.includes('treasure'), path);
    }
    for (const path of ['/', '/document.json', '/part/0', `/${'0'.repeat(32)}/`, `/${'0'.repeat(32)}/document.json`, secret.slice(0, -1), `/x${secret}`]) {
      assert.equal((await ask(address, path)).status, 404, `without the secret: ${path}`);
    }
    for (const method of ['POST', 'PUT', 'DELETE', 'OPTIONS']) assert.notEqual((await ask(address, secret, {}, method)).status, 200, method);
  }),

  'other hosts and other sites are refused': () => withServer(['light.npy'], async (address) => {
    const path = `${address.pathname}document.json`;
    const own = `127.0.0.1:${address.port}`;
    for (const Host of ['evil.example', `evil.example:${address.port}`, '127.0.0.1', `127.0.0.1.evil.example:${address.port}`]) {
      assert.equal((await ask(address, path, { Host })).status, 403, `host ${Host}`);
    }
    assert.equal((await ask(address, path, {}, 'GET', false)).status, 403, 'no host');
    for (const Origin of ['http://evil.example', 'null', `https://${own}`, `http://${own}.evil.example`, `http://evil.example:${address.port}`]) {
      assert.equal((await ask(address, path, { Origin })).status, 403, `origin ${Origin}`);
    }
    assert.equal((await ask(address, path, { 'Sec-Fetch-Site': 'cross-site' })).status, 403);
    const answer = await ask(address, path, { Origin: `http://localhost:${address.port}`, Host: `localhost:${address.port}` });
    assert.equal(answer.status, 200);
    assert.equal(answer.headers['access-control-allow-origin'], undefined);
    assert.match(answer.headers['content-security-policy'], /default-src 'none'/);
  }),

  'it listens on this computer alone, and each time with another secret': () => withServer(['light.npy'], async (address) => {
    const outside = Object.values(os.networkInterfaces()).flat().filter((one) => !one.internal && one.family === 'IPv4');
    for (const { address: host } of outside) assert.ok(await refusesConnections(host, address.port), host);
    await withServer(['light.npy'], async (other) => {
      assert.notEqual(other.pathname, address.pathname);
      assert.match(other.pathname, /^\/[0-9a-f]{32}\/$/);
      assert.equal((await ask(other, address.pathname)).status, 404);
    });
  }),
};
