"""Layered scenes with known disparity for training, drawn with torch and rendered by render.cpp on the CPU."""
import ctypes
import math
import pathlib
import subprocess
import tempfile

import numpy as np
import torch
import torch.nn.functional as F

VIEWS = 8
KINDS = ("objects", "clutter")  # of scenes: a few things in front of a wall, or many surfaces of any outline
KIND_SHARES = [0.6, 0.4]
LAYER_SHARES = {"objects": [0.1, 0.35, 0.35, 0.2], "clutter": [0.06, 0.14, 0.2, 0.2, 0.16, 0.12, 0.07, 0.05]}  # of 1, 2, ... layers
RELIEF_SHARES = {"objects": 0.75, "clutter": 0.35}
WALL_RELIEF_SHARE = 0.2  # of the layers behind all others
BORDER = 3  # of maps, px, as in render.cpp


class Surfaces:
    """Draws the maps of textured surfaces, of which many have weak texture or none: for scenes of one of KINDS.

    photos: uint8 [number, y, x], textures in addition to procedural ones; side: height and width of the maps in px.
    """

    def __init__(self, photos, side, rng):
        self.side, self.rng = side, rng
        self.pyramid = [photos.float().div(255)]
        self.pyramid.append(F.avg_pool2d(self.pyramid[0][:, None], 2)[:, 0])
        self.axis = torch.arange(side).float() - 0.5 * (side - 1)

    @torch.no_grad()
    def maps(self, kind, number):
        """Returns brightness and coverage in [0, 1], [number, side + 2 BORDER, side + 2 BORDER, 2]."""
        textures = self._textures(number)
        if kind == "objects":
            textures, coverages = self._shaded(textures), self._outlines(number)
        else:
            coverages = self._coverages(textures)
        both = torch.stack([textures, coverages], 1)
        return F.pad(both, (BORDER,) * 4, mode="replicate").permute(0, 2, 3, 1).contiguous()

    @torch.no_grad()
    def reliefs(self, number):
        """Returns smooth deviations of the disparity from a plane, [number, side, side], with a slope of at most 0.12."""
        relief = self._noise(number, self._log_uniform(40, 220, number))
        slope = torch.maximum(relief.diff(dim=1).abs().amax((1, 2)), relief.diff(dim=2).abs().amax((1, 2))).view(-1, 1, 1)
        return relief * torch.minimum(self._log_uniform(0.08, 0.9, number), 0.12 / slope)

    # Draws, shaped to be multiplied with maps [number, y, x].
    def _maps(self, values):
        return torch.as_tensor(np.asarray(values, np.float32)).view(-1, 1, 1)

    def _uniform(self, low, high, number):
        return self._maps(self.rng.uniform(low, high, number))

    def _log_uniform(self, low, high, number):
        return self._maps(np.exp(self.rng.uniform(math.log(low), math.log(high), number)))

    def _chance(self, probability, number):
        return self._maps(self.rng.random(number) < probability)

    def _noise(self, number, feature_px):
        """Returns smooth noise of unit variance with features of feature_px [number, 1, 1]."""
        cells = 64
        noise = torch.randn(number, 1, cells, cells)
        span = self.side / feature_px.view(-1, 1).clamp_min(self.side / (cells - 4.0)) / cells
        places = self.axis / (0.5 * self.side) * span
        x, y = (places + self._uniform(-1, 1, number).view(-1, 1) * (1 - span) for _ in range(2))
        grid = torch.stack(torch.broadcast_tensors(x[:, None, :], y[:, :, None]), -1)
        maps = F.grid_sample(noise, grid, mode="bicubic", padding_mode="reflection", align_corners=False)[:, 0]
        return maps / (maps.std(dim=(1, 2), keepdim=True) + 1e-3)

    def _distance_from_line(self, number, offset_px):
        angle = self._uniform(0, 2 * math.pi, number)
        return self.axis * angle.cos() + self.axis[:, None] * angle.sin() + offset_px

    def _stripes(self, number, periods_px, duties):
        period, duty = self._log_uniform(*periods_px, number), self._uniform(*duties, number)
        position = self._distance_from_line(number, self._uniform(0, 1, number) * period) / period
        return (0.5 * duty - (position - position.floor() - 0.5).abs()) * period

    def _photo(self, number):
        maps = torch.empty(number, self.side, self.side)
        zoom = np.exp(self.rng.uniform(math.log(0.6), math.log(2.2), number))
        for level, photos in enumerate(self.pyramid):
            chosen = np.nonzero((zoom > 1.25) == bool(level))[0]
            if not len(chosen):
                continue
            height, width = photos.shape[1:]
            step = self._maps(zoom[chosen] / 2**level)
            angle = self._maps(self.rng.integers(0, 4, len(chosen)) * 0.5 * math.pi)
            flip = self._maps(self.rng.choice([-1, 1], len(chosen)))
            across, down = self.axis * flip, self.axis[:, None]
            x = (across * angle.cos() - down * angle.sin()) * step + self._uniform(0, width, len(chosen))
            y = (across * angle.sin() + down * angle.cos()) * step + self._uniform(0, height, len(chosen))
            source = photos[torch.as_tensor(self.rng.integers(0, len(photos), len(chosen)))]
            grid = torch.stack([x * 2 / width - 1, y * 2 / height - 1], -1)
            maps[chosen] = F.grid_sample(
                source[:, None], grid, mode="bicubic", padding_mode="reflection", align_corners=False)[:, 0]
        return self._tone(maps)

    def _tone(self, maps):
        return maps.clamp(0, 1).pow(self._log_uniform(0.7, 2.0, len(maps)))

    def _fractal(self, number):
        total, amplitude, feature = 0.5, 0.25, self._log_uniform(8, 64, number)
        for _ in range(5):
            total = total + amplitude * self._noise(number, feature.clamp_min(1.5))
            amplitude, feature = amplitude * self._uniform(0.5, 0.8, number), feature / 2
        return self._tone(total)

    def _pattern(self, number):
        inside, other = (self._stripes(number, (4, 40), (0.2, 0.8)) for _ in range(2))
        kind = self.rng.integers(0, 4, number)
        inside = torch.where(self._maps(kind == 2) > 0, torch.minimum(inside, other), inside)
        inside = torch.where(self._maps(kind == 3) > 0, inside * other.sign(), inside)
        dark, bright = self._uniform(0, 1, number), self._uniform(0, 1, number)
        return dark + (bright - dark) * (inside + 0.5).clamp(0, 1)

    def _shading(self, number):
        shape = self._log_uniform(0.05, 0.5, number) * self._noise(number, self._log_uniform(20, 200, number))
        return self._log_uniform(0.05, 0.8, number) * torch.exp(shape)

    def _plain(self, number):
        return self._uniform(0.02, 1.0, number).expand(-1, self.side, self.side)

    def _textures(self, number):
        kinds = [self._photo, self._plain, self._shading, self._fractal, self._pattern]
        kind = self.rng.choice(len(kinds), number, p=[0.6, 0.06, 0.12, 0.12, 0.1])
        maps = torch.empty(number, self.side, self.side)
        for k, draw in enumerate(kinds):
            chosen = np.nonzero(kind == k)[0]
            if len(chosen):
                maps[chosen] = draw(len(chosen))
        weak = self._chance(0.45, number)
        contrast = torch.where(weak > 0, self._log_uniform(0.03, 1.0, number), torch.ones_like(weak))
        mean = maps.mean((1, 2), keepdim=True)
        maps = mean + contrast * (maps - mean) + weak * self._uniform(-0.2, 0.5, number) * (1 - contrast)
        slow = self._noise(number, self._log_uniform(60, 250, number)) * self._log_uniform(0.05, 0.4, number)
        return (maps * torch.exp(self._chance(0.3, number) * slow)).clamp(0, 1)

    def _shaded(self, textures):
        """Makes most textures weak, and adds shading and grain as of plaster."""
        number, mean = len(textures), textures.mean((1, 2), keepdim=True)
        contrast = torch.where(self._chance(0.6, number) > 0, self._log_uniform(0.04, 0.6, number), torch.ones(1))
        shade = self._chance(0.7, number) * self._noise(number, self._log_uniform(40, 300, number)) * self._log_uniform(0.05, 0.5, number)
        grain = self._chance(0.5, number) * self._noise(number, self._log_uniform(1.5, 6, number)) * self._log_uniform(0.01, 0.12, number)
        return ((mean + contrast * (textures - mean)) * torch.exp(shade) * (1 + grain)).clamp(0, 1)

    def _outlines(self, number):
        """Returns the opacity of compact things that are as large as things in pictures: blobs, boxes, ellipses, half planes."""
        half = 0.5 * self.side
        blob = self._distance_inside(self._noise(number, self._log_uniform(50, 260, number)) - self._uniform(-0.6, 0.9, number))
        y = (self.axis[:, None] - self._uniform(-0.8, 0.8, number) * half) / self._log_uniform(25, half, number)
        x = (self.axis - self._uniform(-0.8, 0.8, number) * half) / self._log_uniform(25, half, number)
        radius = torch.where(self._chance(0.35, number) > 0, torch.maximum(x.abs(), y.abs()), (x * x + y * y + 1e-6).sqrt())
        uneven = self._chance(0.6, number) * self._log_uniform(1, 10, number) * self._noise(number, self._log_uniform(20, 100, number))
        line = self._distance_from_line(number, self._uniform(-0.6, 0.4, number) * half)
        kind = self._maps(self.rng.choice(3, number, p=[0.4, 0.45, 0.15]))
        inside = torch.where(kind == 0, blob, torch.where(kind == 1, 50 * (1 - radius) + uneven, line))
        edge_px = torch.where(self._chance(0.8, number) > 0, torch.ones(1), self._log_uniform(1.5, 6, number))
        return (inside / edge_px + 0.5).clamp(0, 1)

    def _distance_inside(self, field):
        """Divides a field of arbitrary units by its mean slope, so that its values near its edges are in px."""
        slope = field.diff(dim=1).abs().mean((1, 2)) + field.diff(dim=2).abs().mean((1, 2))
        return field / (0.7 * slope.view(-1, 1, 1) + 1e-6)

    def _coverages(self, textures):
        """Returns the opacity of surfaces: polygons, ellipses and boxes, stripes, blobs, or parts of the texture."""
        number, half = len(textures), 0.5 * self.side
        kind = self.rng.choice(5, number, p=[0.2, 0.3, 0.12, 0.26, 0.12])
        inside = torch.empty_like(textures)
        for k in range(5):
            chosen = np.nonzero(kind == k)[0]
            if len(chosen):
                at = chosen
                inside[at] = self._inside(k, len(chosen), textures[at], half)
        edge_px = torch.where(self._chance(0.75, number) > 0, torch.ones(1), self._log_uniform(1.5, 8, number))
        opacity = torch.where(self._chance(0.06, number) > 0, self._uniform(0.3, 0.9, number), torch.ones(1))
        return (inside / edge_px + 0.5).clamp(0, 1) * opacity

    def _inside(self, kind, number, textures, half):
        """Returns the distance of each pixel from the outline, positive inside, in px."""
        if kind == 0:
            inside = self._distance_from_line(number, self._uniform(-0.7, 0.3, number) * half)
            for _ in range(2):
                unused = 1e4 * self._chance(0.4, number)
                inside = torch.minimum(inside, self._distance_from_line(number, self._uniform(0, 0.8, number) * half) + unused)
            return inside
        if kind == 1:
            radius_y, radius_x = self._log_uniform(4, half, number), self._log_uniform(4, half, number)
            y = (self.axis[:, None] - self._uniform(-0.8, 0.8, number) * half) / radius_y
            x = (self.axis - self._uniform(-0.8, 0.8, number) * half) / radius_x
            box = torch.maximum(x.abs(), y.abs())
            radius = torch.where(self._chance(0.4, number) > 0, box, (x * x + y * y + 1e-6).sqrt())
            return (1 - radius) * torch.minimum(radius_x, radius_y)
        if kind == 2:
            return self._stripes(number, (8, 60), (0.1, 0.6))
        if kind == 3:
            field = self._noise(number, self._log_uniform(6, 90, number)) - self._uniform(-0.3, 1.2, number)
        else:
            spread = textures.std((1, 2), keepdim=True)
            field = textures - textures.mean((1, 2), keepdim=True) - self._uniform(-0.3, 0.8, number) * spread
        return self._distance_inside(field)


class Layer(ctypes.Structure):
    _fields_ = [("centre", ctypes.c_float), ("slope_y", ctypes.c_float), ("slope_x", ctypes.c_float),
                ("maps", ctypes.c_void_p), ("relief", ctypes.c_void_p)]


def build_renderer():
    source, library = pathlib.Path(__file__).with_name("render.cpp"), pathlib.Path(tempfile.mkdtemp()) / "render.so"
    subprocess.run(["c++", "-O3", "-march=native", "-ffast-math", "-shared", "-fPIC", source, "-o", library], check=True)
    return ctypes.CDLL(str(library))


class Scene:
    """Layers from back to front; keeps the maps alive that they refer to."""

    def __init__(self, renderer, size, side, planes, maps, reliefs):
        self.renderer, self.size, self.side, self.kept = renderer, size, side, (maps, reliefs)
        pointer = lambda tensor: None if tensor is None else tensor.data_ptr()
        self.layers = (Layer * len(maps))(*(Layer(*plane, pointer(m), pointer(r)) for plane, m, r in zip(planes, maps, reliefs)))

    def views(self, numbers):
        """Returns views in [0, 1], [number, y, x]; the number of a view is 8 row + column."""
        at = [np.asarray(numbers) // VIEWS - 3.5, np.asarray(numbers) % VIEWS - 3.5]
        y, x = (np.ascontiguousarray(values, np.float32) for values in at)
        out = torch.empty(len(numbers), self.size, self.size)
        self.renderer.render_views(self.layers, len(self.layers), self.side, self.size, ctypes.c_void_p(y.ctypes.data),
                                   ctypes.c_void_p(x.ctypes.data), len(numbers), ctypes.c_void_p(out.data_ptr()))
        return out

    def disparity(self):
        """Returns the disparity of view (4, 4), [y, x], px per view step."""
        out = torch.empty(self.size, self.size)
        self.renderer.render_disparity(self.layers, len(self.layers), self.side, self.size, ctypes.c_float(0.5), ctypes.c_float(0.5),
                                       ctypes.c_void_p(out.data_ptr()))
        return out


class Scenes:
    """Draws scenes out of a pool of surfaces that is renewed all the time: networks learn scenes by heart that they see again.

    size: height and width of the views in px; max_disparity: in px per view step.
    """

    def __init__(self, renderer, photos, size, max_disparity=3.2, seed=1, pool=160):
        torch.manual_seed(seed)
        self.renderer, self.size, self.max_disparity, self.rng = renderer, size, max_disparity, np.random.default_rng(seed)
        self.side = size + 2 * math.ceil(3.5 * max_disparity)
        self.surfaces = Surfaces(photos, self.side, self.rng)
        self.maps = {kind: [m for _ in range(pool // 16) for m in self.surfaces.maps(kind, 16)] for kind in KINDS}
        self.reliefs, self.drawn = list(self.surfaces.reliefs(48)), 0

    def _renew(self):
        self.drawn += 1
        if self.drawn % 6 == 0:
            kind = KINDS[self.drawn // 6 % 2]
            at = self.drawn // 12 * 16 % len(self.maps[kind])
            self.maps[kind][at:at + 16] = self.surfaces.maps(kind, 16)
        if self.drawn % 100 == 0:
            at = self.drawn // 100 * 16 % len(self.reliefs)
            self.reliefs[at:at + 16] = self.surfaces.reliefs(16)

    def _turned(self, maps):
        for axes, turn in (((0,), torch.flip), ((1,), torch.flip), ((0, 1), lambda m, axes: m.transpose(*axes))):
            maps = turn(maps, axes) if self.rng.random() < 0.5 else maps
        return maps.contiguous()

    def _planes(self, layers):
        """Returns disparity and slopes per px, from back to front: nearer surfaces have the smaller disparity."""
        rng = self.rng
        limit = self.max_disparity * rng.choice([0.3, 0.65, 1.0, 1.0])
        high = rng.uniform(-0.5, 1) * limit
        centre = -np.sort(-rng.uniform(rng.uniform(-limit, high), high, layers))
        room = np.minimum(np.maximum(self.max_disparity - np.abs(centre), 0) / self.size, 0.025)
        slopes = [rng.uniform(-1, 1, layers) * room * (rng.random(layers) < 0.6) for _ in range(2)]
        return list(zip(centre, *slopes))

    def draw(self):
        rng = self.rng
        self._renew()
        kind = str(rng.choice(KINDS, p=KIND_SHARES))
        planes, pool = self._planes(int(rng.choice(len(LAYER_SHARES[kind]), p=LAYER_SHARES[kind])) + 1), self.maps[kind]
        maps = [self._turned(pool[i]) for i in rng.choice(len(pool), len(planes), replace=False)]
        shares = [WALL_RELIEF_SHARE, *[RELIEF_SHARES[kind]] * (len(planes) - 1)]
        reliefs = [self._turned(self.reliefs[rng.integers(len(self.reliefs))]) * int(rng.choice([-1, 1])) if rng.random() < share else None
                   for share in shares]
        return Scene(self.renderer, self.size, self.side, planes, maps, reliefs)


class Batches(torch.utils.data.IterableDataset):
    """Batches without end: intensities through the codes and the open aperture [batch, N + 1, y, x], the disparity [batch, y, x] of
    view (4, 4), and the views in the rows and columns that are drawn for the batch, [batch, row, column, y, x], or none."""

    def __init__(self, photos, codes, batch, size, seed, num_views):
        super().__init__()
        self.photos, self.codes, self.batch, self.size, self.seed, self.num_views = photos, codes, batch, size, seed, num_views

    def __iter__(self):
        worker = torch.utils.data.get_worker_info()
        torch.set_num_threads(1)
        scenes = Scenes(build_renderer(), self.photos, self.size, seed=self.seed + (worker.id if worker else 0))
        others = np.array([0, 1, 2, 3, 5, 6, 7])
        # The open aperture is approximated by the open views and a third of the others.
        used = self.codes.sum(0) > 0
        sparse = torch.arange(VIEWS**2)[~used][::3]
        weights = torch.cat([self.codes, used[None].float()]) / VIEWS**2
        weights[-1, sparse] = float((~used).sum()) / len(sparse) / VIEWS**2
        coded_views = torch.nonzero(weights.sum(0))[:, 0]
        while True:
            rows, columns = ([4, *scenes.rng.choice(others, self.num_views - 1, replace=False)] if self.num_views else [] for _ in range(2))
            wanted = [VIEWS * row + column for row in rows for column in columns]
            drawn = [scenes.draw() for _ in range(self.batch)]
            coded = torch.stack([torch.einsum("pv,vyx->pyx", weights[:, coded_views], scene.views(coded_views)) for scene in drawn])
            views = torch.stack([scene.views(wanted) for scene in drawn]).unflatten(1, (len(rows), len(columns))) if wanted else coded[:, :0]
            yield coded, torch.stack([scene.disparity() for scene in drawn]), views, (rows, columns)
