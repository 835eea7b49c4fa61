"""Networks from events to disparity, as lists of layers in the form of model files, and their operation plane-sweep, which compares the
pictures behind the patterns at each of a list of disparities."""
import math

import torch
import torch.nn.functional as F

DISPARITIES = [round(-3.4 + 0.2 * i, 3) for i in range(35)]
FEATURES = 4  # of each picture
SWEEP_SCALE = 4


def conv(name, source, out, kernel=3, stride=1, relu=False, residual=""):
    return {"name": name, "op": "conv", "inputs": [source], "out_channels": out, "kernel": kernel, "stride": stride, "relu": relu,
            "residual": residual}


def sweep_layers(offsets, whole_cycle):
    """The pictures at a quarter of the resolution, their features, and the evidence for each disparity. At half resolution, the
    noise of single pixels hides the evidence (docs/experiments/geometry.md)."""
    scaled = [[row / SWEEP_SCALE, column / SWEEP_SCALE] for row, column in offsets]
    return [conv("pictures", "input", 6 if whole_cycle else 3, SWEEP_SCALE, SWEEP_SCALE), conv("features", "pictures", 3 * FEATURES, 5),
            {"name": "sweep", "op": "plane-sweep", "inputs": ["features"], "kernel": 7, "offsets": scaled, "disparities": DISPARITIES}]


def unet(layers, x, widths, blocks):
    """Appends a residual U-Net that receives the evidence at a quarter of the resolution; returns the name of its output."""
    def residual_blocks(tag, x, width, number):
        for i in range(number):
            layers.append(conv(f"{tag}_{i}a", x, width, relu=True))
            layers.append(conv(f"{tag}_{i}b", f"{tag}_{i}a", width, residual=x))
            x = f"{tag}_{i}b"
        return x

    skips, last = [], len(widths) - 1
    for level in range(last):
        x = residual_blocks(f"down{level}", x, widths[level], blocks[level])
        skips.append(x)
        layers.append(conv(f"down{level}_half", x, widths[level + 1], 2, 2))
        x = f"down{level}_half"
        if level == 0:
            layers.append({"name": "evidence", "op": "concat", "inputs": [x, "sweep", "features"]})
            layers.append(conv("weigh", "evidence", widths[1], residual=x))
            x = "weigh"
    x = residual_blocks("middle", x, widths[last], blocks[last])
    for level in reversed(range(last)):
        layers.append({"name": f"up{level}_double", "op": "conv-transposed", "inputs": [x], "out_channels": widths[level], "kernel": 2, "stride": 2})
        layers.append({"name": f"up{level}_join", "op": "add", "inputs": [f"up{level}_double", skips[level]]})
        x = residual_blocks(f"up{level}", f"up{level}_join", widths[level], blocks[level])
    return x


def depth_network(offsets, whole_cycle=False, widths=(40, 64, 88, 112, 128, 128)):
    """Disparity of view (4, 4) and the logarithm of its scale, [2, y, x]; 43 k multiply-adds per pixel."""
    layers = [conv("stem", "input", widths[0], 2, 2, relu=True), conv("start", "stem", widths[0]), *sweep_layers(offsets, whole_cycle)]
    x = unet(layers, "start", list(widths), [1] * len(widths))
    layers.append(conv("head", x, 8))
    layers.append({"name": "output", "op": "pixel-shuffle", "inputs": ["head"], "stride": 2})
    return layers


class Network(torch.nn.Module):
    """The network of a list of layers; parameters are named as in model files, with a slash for the dot."""

    def __init__(self, layers, input_channels):
        super().__init__()
        self.layers, self.weights, channels = layers, torch.nn.ParameterDict(), {"input": input_channels}
        for layer in layers:
            name, inputs = layer["name"], [channels[source] for source in layer["inputs"]]
            channels[name] = layer.get("out_channels", {"concat": sum(inputs), "pixel-unshuffle": inputs[0] * 4, "pixel-shuffle": inputs[0] // 4,
                                                        "plane-sweep": len(layer.get("disparities", ()))}.get(layer["op"], inputs[0]))
            if "out_channels" in layer:
                self._add(layer, inputs[0])

    def _add(self, layer, inputs):
        out, kernel = layer["out_channels"], layer["kernel"]
        is_transposed = layer["op"] == "conv-transposed"
        shape = (inputs, out, kernel, kernel) if is_transposed else (out, inputs, kernel, kernel)
        fan_in = inputs if is_transposed else inputs * kernel * kernel
        gain = math.sqrt((2 if layer.get("relu") else 1) / fan_in) * (0.3 if layer.get("residual") else 1)
        self.weights[layer["name"] + "/weight"] = torch.nn.Parameter(gain * torch.randn(shape))
        self.weights[layer["name"] + "/bias"] = torch.nn.Parameter(torch.zeros(out))

    def forward(self, x):
        values, sources = {"input": x}, lambda layer: [*layer["inputs"], *([layer["residual"]] if layer.get("residual") else [])]
        last_use = {name: i for i, layer in enumerate(self.layers) for name in sources(layer)}
        for i, layer in enumerate(self.layers):
            y = self._output_of(layer, [values[name] for name in layer["inputs"]])
            if layer.get("residual"):
                y = y + values[layer["residual"]]
            values[layer["name"]] = F.relu(y) if layer.get("relu") else y
            for name in sources(layer):
                if last_use[name] == i:
                    values.pop(name, None)
        return y

    def _output_of(self, layer, inputs):
        op, name, kernel, stride = layer["op"], layer["name"], layer.get("kernel", 1), layer.get("stride", 1)
        if op in ("conv", "conv-transposed"):
            weight, bias = self.weights[name + "/weight"], self.weights[name + "/bias"]
            if op == "conv-transposed":
                return F.conv_transpose2d(inputs[0], weight, bias, stride)
            return F.conv2d(inputs[0], weight, bias, stride, 0 if kernel == stride else kernel // 2)
        return {"pixel-unshuffle": lambda: F.pixel_unshuffle(inputs[0], stride), "pixel-shuffle": lambda: F.pixel_shuffle(inputs[0], stride),
                "add": lambda: inputs[0] + inputs[1], "concat": lambda: torch.cat(inputs, 1),
                "plane-sweep": lambda: plane_sweep(inputs[0], layer)}[op]()


def start_features(network, num_patterns):
    """Starts with pictures of the log intensity, and with its details and gradients as features."""
    binomial, derivative, centre = torch.tensor([1.0, 2.0, 1.0]), torch.tensor([-1.0, 0.0, 1.0]), torch.zeros(5, 5)
    centre[2, 2] = 1
    framed = lambda row, column: F.pad(torch.outer(row, column), (1, 1, 1, 1))
    kernels = [centre - 1 / 25, framed(binomial, derivative), framed(derivative, binomial), framed(binomial, binomial) / 16 - 1 / 25]
    with torch.no_grad():
        pictures, features = network.weights["pictures/weight"], network.weights["features/weight"]
        pictures.mul_(0.02), features.mul_(0.3)
        for p in range(3):
            pictures[p] = 0
            pictures[p, num_patterns - 1 + p] = 2.4 / SWEEP_SCALE**2  # of 0.125 counts: thresholds of 0.3
            for g, kernel in enumerate(kernels):
                features[p * FEATURES + g] = 0
                features[p * FEATURES + g, p] = 8 * kernel / kernel.norm()


_matrices = {}


def shift_matrices(size, offsets, like):
    """Returns matrices [offset, size, size] with (M x)[i] = x(i + offset), linear with zeros outside."""
    key = (size, tuple(round(float(offset), 5) for offset in offsets), like.dtype, like.device)
    if key in _matrices:
        return _matrices[key]
    matrices, rows = torch.zeros(len(offsets), size, size), torch.arange(size)
    for matrix, offset in zip(matrices, offsets):
        whole = math.floor(offset)
        for tap, weight in ((0, 1 - offset + whole), (1, offset - whole)):
            columns = rows + whole + tap
            inside = (columns >= 0) & (columns < size)
            matrix.index_put_((rows[inside], columns[inside]), torch.tensor(float(weight)).expand(int(inside.sum())), accumulate=True)
    _matrices[key] = matrices.to(like)
    return _matrices[key]


def plane_sweep(x, layer):
    """Compares P pictures of G features, [batch, P G, y, x], at K disparities: [batch, K, y, x]. Picture p is read at offset_p * d.
    The result is the mean over the features of the sum of the products of all pairs, C / (1 + E), where E is the sum of the squares and
    both are averaged over a window."""
    with torch.autocast(x.device.type, enabled=False):  # half precision hides small evidence
        return _plane_sweep(x.float(), layer)


def _plane_sweep(x, layer):
    offsets, disparities, kernel = layer["offsets"], layer["disparities"], layer["kernel"]
    batch, channels, height, width = x.shape
    planes, features = len(disparities), channels // len(offsets)
    total, energy = 0, 0
    for picture, (row, column) in zip(x.view(batch, len(offsets), features, height, width).unbind(1), offsets):
        across = shift_matrices(width, [d * column for d in disparities], x).reshape(planes * width, width)
        down = shift_matrices(height, [d * row for d in disparities], x)
        moved = (picture.reshape(-1, width) @ across.t()).view(batch, features, height, planes, width)
        moved = torch.bmm(down, moved.permute(3, 2, 0, 1, 4).reshape(planes, height, -1))
        total, energy = total + moved, energy + moved * moved
    both = torch.stack([0.5 * (total * total - energy), energy]).view(2, planes, height, batch, features, width).mean(4)
    both = F.avg_pool2d(both.permute(0, 3, 1, 2, 4).reshape(2 * batch, planes, height, width), kernel, 1, kernel // 2)
    evidence, energy = both.view(2, batch, planes, height, width)
    return evidence / (1 + energy)
