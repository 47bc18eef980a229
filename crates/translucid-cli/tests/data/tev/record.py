"""Records the packets of tev's own client, with which `render/tev/packet.rs` compares ours.

    pip install tevclient==1.0.4 numpy
    python record.py            writes tevclient-1.0.4.bin
    python record.py --check    compares the file with what the client makes
"""

import sys
from pathlib import Path

import numpy as np
from tevclient import Ipc, __version__


class Recorder:
    def __init__(self):
        self.bytes = bytearray()

    def sendall(self, data):
        self.bytes.extend(data)


def main():
    assert __version__ == "1.0.4", __version__
    y, x, c = np.meshgrid(np.arange(2), np.arange(130), np.arange(4), indexing="ij")
    picture = (x + 256 * y + c / 4).astype(np.float32)
    client = Ipc()
    client._socket = recorder = Recorder()
    client.close_image("ä b.exr")
    client.create_image("ä b.exr", 200, 9)
    client.update_image("ä b.exr", picture, x=3, y=5)
    path = Path(__file__).parent / f"tevclient-{__version__}.bin"
    if "--check" in sys.argv:
        assert path.read_bytes() == recorder.bytes
    else:
        path.write_bytes(recorder.bytes)


main()
