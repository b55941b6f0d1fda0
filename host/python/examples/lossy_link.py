"""Sends a picture by UDP over a link that loses some packets, and draws what has come after each.

    python lossy_link.py PICTURE FOLDER [--size N] [--count N] [--loss P] [--expected P] [--seed N] [--effort N]

FOLDER gets a PNG file after each packet.  Sender and receiver are two threads of this program, on the loopback interface, where
hardly anything is lost: the sender drops packets at random.
"""

import argparse
import pathlib
import random
import socket
import threading

from PIL import Image

import gscl


def send(packets, address, loss, seed):
    """Sends the packets that are not lost, then an empty one, which ends the picture."""
    dice = random.Random(seed)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        for packet in packets:
            if dice.random() >= loss:
                link.sendto(packet, address)
        link.sendto(b"", address)


def receive(link, picture, folder):
    """Draws the picture whenever a packet adds to it."""
    decoder = gscl.Decoder()
    while packet := link.recv(1400):
        try:
            is_new = decoder.add(packet)
        except gscl.FileError as error:  # damaged on the way, or of another sender
            print(f"left out {len(packet)} bytes: {error}")
            continue
        if is_new and decoder.splats:  # a repair packet alone draws nothing
            drawn = decoder.image()
            Image.fromarray(drawn).save(folder / f"{decoder.received:03}.png")
            print(f"{decoder.received} came, {decoder.drawn} of {decoder.packets} drawn, {gscl.compare(picture, drawn).psnr:.2f} dB")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--size", type=int, default=152, help="bytes of a packet (%(default)s)")
    parser.add_argument("--count", type=int, default=10, help="packets (%(default)s)")
    parser.add_argument("--loss", type=float, default=0.2, help="share of packets that the link loses (%(default)s)")
    parser.add_argument("--expected", type=float, default=0.0, help="share that repair packets are made for (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the losses (%(default)s)")
    parser.add_argument("--effort", type=int, default=5)
    arguments = parser.parse_args()

    with Image.open(arguments.picture) as image:
        picture = image.convert("RGB")
    encoded = gscl.encode(
        picture, packets=arguments.size, packet_count=arguments.count, packet_loss=arguments.expected, effort=arguments.effort
    )
    packets, report = encoded.packets, encoded.report
    print(f"{len(packets)} packets, {report.bytes} bytes, {report.psnr:.2f} dB with all of them")
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.bind(("127.0.0.1", 0))
        link.settimeout(60)
        threading.Thread(target=send, args=(packets, link.getsockname(), arguments.loss, arguments.seed)).start()
        receive(link, picture, arguments.folder)


if __name__ == "__main__":
    main()
