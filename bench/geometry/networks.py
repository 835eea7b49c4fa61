"""The network from events to disparity for any patterns, and its operation plane-sweep, which compares the pictures behind the patterns at
each of a list of disparities. Parameters are named as in model files."""
import math

import torch
import torch.nn.functional as F

import patterns
from sensor import FIXED_CONDITIONS

DISPARITIES = [round(-3.4 + 0.2 * i, 3) for i in range(35)]
FEATURES = 4  # of each picture
KINDS = 3  # of pictures that have weights of their own: the first, the second, and those after it
SWEEP_SCALE = 4
GROUPS = 3  # of event planes: cumulative counts, levels, intensities
WINDOW = 7  # of the comparison, px of its scale
CONSTANTS = patterns.CONSTANTS + patterns.SLOTS + FIXED_CONDITIONS  # of the patterns, their transmissions, and the sensor
STEM_INPUTS = patterns.SLOTS * GROUPS + patterns.MOMENTS + CONSTANTS


def aperture_planes(groups, aperture):
    """Returns the slots of each group and the moments of the intensities, [batch, 12, y, x]; groups: [batch, 3, P, y, x]."""
    slots = torch.matmul(aperture.slots[:, None], groups.flatten(3))
    moments = torch.matmul(aperture.moments * aperture.gains[:, None], groups[:, 2].flatten(2))
    return torch.cat([slots.flatten(1, 2), moments], 1).unflatten(2, groups.shape[3:])


def with_neighbours(pictures):
    """Returns each of P pictures, [batch, P, n, y, x], with the one before it (the one after it for the first) and the mean of all:
    [batch, P, 3 n, y, x]."""
    before = torch.cat([pictures[:, 1:2], pictures[:, :-1]], 1)
    return torch.cat([pictures, before, pictures.mean(1, keepdim=True).expand_as(pictures)], 2)


def of_its_kind(pictures):
    """Takes the channels of each picture that were made with the weights of its kind: the first one, which follows the black pattern, the
    second, and those after it."""
    kinds = pictures.chunk(KINDS, 2)
    return torch.cat([kinds[min(p, KINDS - 1)][:, p:p + 1] for p in range(pictures.shape[1])], 1)


def hats(size, offsets):
    """Returns matrices [..., size, size] with (M x)[i] = x(i + offset), linear with zeros outside, for offsets [...]."""
    axis = torch.arange(size, device=offsets.device, dtype=torch.float32)
    return (1 - (axis - axis[:, None] - offsets[..., None, None]).abs()).clamp_min_(0)


def plane_sweep(x, offsets):
    """Compares P pictures of G features, [batch, P, G, y, x], at K disparities: [batch, K, y, x]. Picture p is read at offset_p * d; offsets
    [batch, P, 2] in px of the pictures per px of disparity. The result is the mean over the features of the sum of the products of all
    pairs, C / (1 + E), where E is the sum of the squares and both are averaged over a window."""
    batch, number, features, height, width = x.shape
    disparities = torch.tensor(DISPARITIES, device=x.device)
    planes = len(DISPARITIES)
    total, energy = 0, 0
    for picture, (row, column) in zip(x.unbind(1), (offset.unbind(1) for offset in offsets.unbind(1))):
        across = hats(width, column[:, None] * disparities).view(batch, planes * width, width)
        down = hats(height, row[:, None] * disparities).view(batch * planes, height, height)
        moved = torch.bmm(picture.reshape(batch, features * height, width), across.transpose(1, 2)).view(batch, features, height, planes, width)
        moved = torch.bmm(down, moved.permute(0, 3, 2, 1, 4).reshape(batch * planes, height, features * width))
        total, energy = total + moved, energy + moved * moved
    both = torch.stack([0.5 * (total * total - energy), energy]).view(2 * batch, planes, height, features, width).mean(3)
    evidence, energy = F.avg_pool2d(both, WINDOW, 1, WINDOW // 2).view(2, batch, planes, height, width)
    return evidence / (1 + energy)


class DepthNetwork(torch.nn.Module):
    """Disparity of view (4, 4) and the logarithm of its scale, [2, y, x]; 43 k multiply-adds per pixel."""

    def __init__(self, widths=(40, 64, 88, 112, 128, 128)):
        super().__init__()
        self.widths, self.weights = widths, torch.nn.ParameterDict()
        w = widths
        self._conv("stem", w[0], STEM_INPUTS, 2, relu=True)
        self._conv("start", w[0], w[0], 3)
        self._conv("pictures", KINDS, 3 * GROUPS + CONSTANTS, SWEEP_SCALE)
        self._conv("features", KINDS * FEATURES, 3, 5)
        for level in range(len(w) - 1):
            self._block(f"down{level}_0", w[level])
            self._conv(f"down{level}_half", w[level + 1], w[level], 2)
            if level == 0:
                self._conv("weigh", w[1], w[1] + len(DISPARITIES) + (patterns.SLOTS + patterns.MOMENTS) * FEATURES, 3, residual=True)
            self._conv(f"up{level}_double", w[level], w[level + 1], 2, is_transposed=True)
            self._block(f"up{level}_0", w[level])
        self._block("middle_0", w[-1])
        self._conv("head", 8, w[0], 3)

    def _conv(self, name, out, inputs, kernel, relu=False, residual=False, is_transposed=False):
        shape = (inputs, out, kernel, kernel) if is_transposed else (out, inputs, kernel, kernel)
        gain = math.sqrt((2 if relu else 1) / (inputs if is_transposed else inputs * kernel * kernel)) * (0.3 if residual else 1)
        self.weights[name + "/weight"] = torch.nn.Parameter(gain * torch.randn(shape))
        self.weights[name + "/bias"] = torch.nn.Parameter(torch.zeros(out))

    def _block(self, name, width):
        self._conv(name + "a", width, width, 3, relu=True)
        self._conv(name + "b", width, width, 3, residual=True)

    def _of(self, name, x, stride=1):
        weight, bias = self.weights[name + "/weight"], self.weights[name + "/bias"]
        return F.conv2d(x, weight, bias, stride, 0 if weight.shape[2] == stride else weight.shape[2] // 2)

    def _blocked(self, name, x):
        return x + self._of(name + "b", F.relu(self._of(name + "a", x)))

    def _sized(self, name, x, constants, stride):
        """A convolution whose kernel is its stride, of planes, of constants [batch, n] for the next n channels, and of a last plane."""
        weight, first = self.weights[name + "/weight"], x.shape[1] - 1
        of_planes = torch.cat([weight[:, :first], weight[:, -1:]], 1)
        return F.conv2d(x, of_planes, None, stride) + (self.weights[name + "/bias"] + constants @ weight[:, first:-1].sum((2, 3)).t())[:, :, None, None]

    def _features(self, groups, constants, cycles, number):
        """Returns the features of each picture, [batch, P, G, y, x], which are made of it, of the one before, and of the mean of all."""
        batch = len(groups)
        apart = lambda x: x.view(batch, number, *x.shape[1:])
        planes = torch.cat([with_neighbours(groups.transpose(1, 2)), cycles[:, None, None].expand(-1, number, -1, -1, -1)], 2).flatten(0, 1)
        pictures = of_its_kind(apart(self._sized("pictures", planes, constants.repeat_interleave(number, 0), SWEEP_SCALE)))
        return of_its_kind(apart(self._of("features", with_neighbours(pictures).flatten(0, 1))))

    def forward(self, groups, conditions, cycles, transmissions, aperture):
        """groups: [batch, 3, P, y, x]; conditions: [batch, 15]; cycles: the last element of the conditions, [batch, y, x]; transmissions:
        those of the conditioning vector, [batch, P], 0 for the first."""
        constants = torch.cat([aperture.constants, torch.einsum("bsp,bp->bs", aperture.slots, transmissions), conditions], 1)
        planes = torch.cat([aperture_planes(groups, aperture), cycles[:, None]], 1)
        x = self._of("start", F.relu(self._sized("stem", planes, constants, 2)))
        features = self._features(groups, constants, cycles, aperture.number)
        with torch.autocast(x.device.type, enabled=False):  # half precision hides small evidence
            features = features.float()
            compared = features * (aperture.weights * 3 / aperture.number).sqrt()[:, :, None, None, None]
            sweep = plane_sweep(compared, aperture.offsets / SWEEP_SCALE) * (2 / max(1, aperture.number - 1))
            details = torch.einsum("bcp,bpgyx->bcgyx", torch.cat([aperture.slots, aperture.moments], 1), features).flatten(1, 2)
        skips = []
        for level in range(len(self.widths) - 1):
            x = self._blocked(f"down{level}_0", x)
            skips.append(x)
            x = self._of(f"down{level}_half", x, 2)
            if level == 0:
                x = x + self._of("weigh", torch.cat([x, sweep.to(x.dtype), details.to(x.dtype)], 1))
        x = self._blocked("middle_0", x)
        for level in reversed(range(len(self.widths) - 1)):
            x = F.conv_transpose2d(x, self.weights[f"up{level}_double/weight"], self.weights[f"up{level}_double/bias"], 2) + skips[level]
            x = self._blocked(f"up{level}_0", x)
        return F.pixel_shuffle(self._of("head", x), 2)


def shared_kernels(kernels):
    """Returns what the kernels [3, 3, ...] of each of three pictures have to do with the picture itself, with its neighbour, and with the
    mean of all: [kind, part, ...]."""
    result = []
    for p, neighbour, other in (0, 1, 2), (1, 0, 2), (2, 1, 0):
        result.append(torch.stack([kernels[p, p] - kernels[p, other], kernels[p, neighbour] - kernels[p, other], KINDS * kernels[p, other]]))
    return torch.stack(result)


@torch.no_grad()
def start_from_fixed(network, tensors, codes):
    """Takes the weights of a network for fixed lit patterns [P, 64], by name, so that both agree for these patterns as far as possible."""
    number, put = len(codes), lambda name, values: network.weights[name].copy_(values)
    of = lambda name: torch.as_tensor(tensors[name])
    for name, weight in network.weights.items():
        source = name.replace("/", ".")
        if source in tensors and tensors[source].shape == tuple(weight.shape):
            put(name, of(source))

    def split(weight):
        """Returns the weights of the groups, [out, P, y, x] each, and those of the constants and the number of cycles."""
        counts, *groups, conditions, transmissions = weight.split([number] * 4 + [FIXED_CONDITIONS, number - 1], 1)
        groups[0] = groups[0] + counts - F.pad(counts[:, 1:], (0, 0, 0, 0, 0, 1))  # counts are differences of cumulative counts
        patterns_and_first = torch.zeros(len(weight), patterns.CONSTANTS + 1, *weight.shape[2:])
        return groups, torch.cat([patterns_and_first, transmissions, conditions], 1)

    groups, of_constants = split(of("stem.weight"))
    put("stem/weight", torch.cat([*groups, torch.zeros(len(of_constants), patterns.MOMENTS, 2, 2), of_constants], 1))
    groups, of_constants = split(of("pictures.weight"))
    shared = torch.stack([shared_kernels(g) for g in groups], 2)  # [kind, part, group, y, x]
    put("pictures/weight", torch.cat([shared.flatten(1, 2), of_constants], 1))
    for name in "stem/bias", "pictures/bias":
        put(name, of(name.replace("/", ".")))
    kernels = of("features.weight").view(number, FEATURES, number, 5, 5).transpose(1, 2)
    put("features/weight", shared_kernels(kernels).transpose(1, 2).flatten(0, 1))
    put("features/bias", of("features.bias"))
    weigh = of("weigh.weight")
    put("weigh/weight", F.pad(weigh, (0, 0, 0, 0, 0, patterns.MOMENTS * FEATURES)))
