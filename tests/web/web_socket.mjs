/* A client of WebSocket (RFC 6455) for text messages, which Node has from version 22 on: {send, close}. */
import {randomBytes} from 'node:crypto';
import {get} from 'node:http';

const FIN = 128, MASKED = 128, OPCODE = 15, LENGTH = 127;
const CONTINUATION = 0, TEXT = 1, CLOSE = 8, PING = 9, PONG = 10;

/* A frame of a client, which masks its bytes. */
const frameOf = (opcode, payload) => {
  const {length} = payload, mask = randomBytes(4), size = length < 126 ? 0 : length < 65536 ? 2 : 8; /* bytes of a longer length */
  const head = Buffer.alloc(2 + size);
  head[0] = FIN | opcode;
  head[1] = MASKED | (size == 8 ? 127 : size == 2 ? 126 : length);
  if (size)
    head.writeUIntBE(length, head.length - Math.min(size, 6), Math.min(size, 6));
  return Buffer.concat([head, mask, payload.map((byte, i) => byte ^ mask[i % 4])]);
};

/* The first frame of bytes, and the bytes after it; undefined where it is not whole. */
const firstFrame = bytes => {
  const short = bytes[1] & LENGTH, size = short == 127 ? 8 : short == 126 ? 2 : 0, start = 2 + size;
  if (bytes.length < start) /* also where not even the two bytes are there */
    return undefined;
  const length = size ? bytes.readUIntBE(start - Math.min(size, 6), Math.min(size, 6)) : short, end = start + length;
  return bytes.length < end ? undefined : {isLast: bytes[0] >= FIN, opcode: bytes[0] & OPCODE, payload: bytes.subarray(start, end), rest: bytes.subarray(end)};
};

/* Gives onFrame the frames of a socket, whatever the parts that they come in. */
const readFrames = (socket, bytes, onFrame) => {
  const take = data => {
    bytes = Buffer.concat([bytes, data]);
    for (let frame; (frame = firstFrame(bytes)); bytes = frame.rest)
      onFrame(frame);
  };
  socket.on('data', take);
  take(Buffer.alloc(0));
};

export const connect = (url, onText) => new Promise((resolve, reject) => {
  const headers = {connection: 'Upgrade', upgrade: 'websocket', 'sec-websocket-version': 13, 'sec-websocket-key': randomBytes(16).toString('base64')};
  get(url.replace(/^ws/, 'http'), {headers}, ({statusCode}) => reject(Error(`${url}: status ${statusCode}`))).on('error', reject).on('upgrade', (_, socket, first) => {
    const send = (opcode, payload) => socket.write(frameOf(opcode, payload));
    let message = []; /* payloads of the frames of a text that is not whole */
    readFrames(socket, first, ({isLast, opcode, payload}) => {
      if (opcode == PING)
        send(PONG, payload);
      if (opcode == TEXT || opcode == CONTINUATION)
        message.push(payload);
      if (isLast && message.length && opcode < CLOSE)
        onText(Buffer.concat(message.splice(0)).toString());
    });
    socket.on('error', () => socket.destroy());
    resolve({send: text => send(TEXT, Buffer.from(text)), close: () => socket.end()});
  });
});
