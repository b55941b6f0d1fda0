/* decode, info and splats, which also take an array of packets; gscl.d.ts describes them.  Once this file is imported, gscl.js
 * and the element fetch the module that reads packets. */
import {decode as decodeFile, info as readInfo, useFile} from './gscl.js';
import {splats as readSplats} from './splats.js';

useFile(() => new URL('gscl-packets.wasm', import.meta.url));

const MAGIC = [0xc7, 0x67, 0x73, 0x70];
const MAX_SIZE = 2 ** 21 - 1; /* bytes of a packet in a list */

const bytesOf = packet => new Uint8Array(packet?.buffer || packet, packet?.byteOffset, packet?.byteLength);
const varint = size => size > 127 ? [size & 127 | 128, ...varint(size >> 7)] : [size];

/* The list of packets (FORMAT.md, "Packets") that an array stands for; another source as it is. */
const listOf = source => Array.isArray(source)
  ? new Uint8Array([...MAGIC, ...source.map(bytesOf).filter(({length}) => length <= MAX_SIZE).flatMap(packet => [...varint(packet.length), ...packet])])
  : source;
const withPackets = read => async (source, options) => read(listOf(source), options);

export const decode = withPackets(decodeFile);
export const info = withPackets(readInfo);
export const splats = withPackets(readSplats);
