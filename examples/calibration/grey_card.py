#!/usr/bin/env python3
"""Writes a card of 5x3 even patches as a light field, and patterns with known open areas, to rehearse a calibration.

    python3 grey_card.py card.npy known.json      needs numpy
"""

import json
import sys

import numpy as np

brightness = 0.01 * 1.35 ** (np.arange(15) * 7 % 15)
card = np.kron(brightness.reshape(3, 5), np.ones((100, 100)))
np.save(sys.argv[1], np.broadcast_to(card, (8, 8, *card.shape)).astype(np.float32))
patterns = [["".join("1" if 8 * row + column < count else "0" for column in range(8)) for row in range(8)]
            for count in (0, 8, 48, 16)]
json.dump({"patterns": patterns}, open(sys.argv[2], "w"))
