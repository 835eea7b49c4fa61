"""Scenes with known disparity for training, drawn with torch and rendered by render.cpp on the CPU or on a GPU."""
import ctypes
import io
import math
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np
import torch
import torch.nn.functional as F
from PIL import Image

VIEWS = 8
BORDER = 3  # of maps, px, as in render.cpp
ROOM_SHARE = 0.6  # of the scenes: walls, a floor, and a few things before them; the others consist of many surfaces of any outline
PLANE_SHARES = [0.35, 0.45, 0.2]  # of rooms with 0, 1, ... planes besides the wall
THING_SHARES = [0.08, 0.27, 0.3, 0.2, 0.15]  # of rooms with 0, 1, ... things
CLUTTER_SHARES = [0.0, 0.06, 0.14, 0.2, 0.2, 0.16, 0.12, 0.07, 0.05]  # of the other scenes with 0, 1, ... surfaces
CHEQUER_SHARE = 0.05  # of walls and planes
STEEPEST = 0.1  # slope of a disparity, by which the points of a view are found in few steps (render.cpp)


def to_device(values, device):
    """Copies an array of numpy to a device without waiting for the work that it still has to do."""
    tensor = torch.from_numpy(np.ascontiguousarray(values))
    return tensor.pin_memory().to(device, non_blocking=True) if device.type == "cuda" else tensor


class Surfaces:
    """Draws maps of surfaces, of which many have weak texture or none.

    photos: uint8 [number, y, x], textures in addition to procedural ones; side: height and width of the maps in px.
    """

    def __init__(self, photos, side, rng, device):
        self.side, self.rng, self.device = side, rng, device
        self.pyramid = [photos.to(device).float().div(255)]
        self.pyramid.append(F.avg_pool2d(self.pyramid[0][:, None], 2)[:, 0])
        self.axis = torch.arange(side, device=device).float() - 0.5 * (side - 1)

    # Draws, shaped to be multiplied with maps [number, y, x].
    def uniform(self, low, high, number):
        return low + (high - low) * torch.rand(number, 1, 1, device=self.device)

    def log_uniform(self, low, high, number):
        return torch.exp(self.uniform(math.log(low), math.log(high), number))

    def chance(self, probability, number):
        return (torch.rand(number, 1, 1, device=self.device) < probability).float()

    def by_kind(self, number, shares, draw):
        """Returns draw(kind, range) for ranges whose lengths follow the shares, one after another."""
        ends = np.cumsum(self.rng.multinomial(number, shares))
        return torch.cat([draw(kind, slice(end - length, end)) for kind, (end, length) in enumerate(zip(ends, np.diff(ends, prepend=0))) if length])

    def noise(self, number, feature_px):
        """Returns smooth noise of unit variance with features of feature_px [number, 1, 1]."""
        cells = 64
        noise = torch.randn(number, 1, cells, cells, device=self.device)
        span = self.side / feature_px.view(-1, 1).clamp_min(self.side / (cells - 4.0)) / cells
        places = self.axis / (0.5 * self.side) * span
        x, y = (places + self.uniform(-1, 1, number).view(-1, 1) * (1 - span) for _ in range(2))
        grid = torch.stack(torch.broadcast_tensors(x[:, None, :], y[:, :, None]), -1)
        maps = F.grid_sample(noise, grid, mode="bicubic", padding_mode="reflection", align_corners=False)[:, 0]
        return maps / (maps.std(dim=(1, 2), keepdim=True) + 1e-3)

    def distance_from_line(self, number, offset_px):
        angle = self.uniform(0, 2 * math.pi, number)
        return self.axis * angle.cos() + self.axis[:, None] * angle.sin() + offset_px

    def _stripes(self, number, periods_px, duties):
        period, duty = self.log_uniform(*periods_px, number), self.uniform(*duties, number)
        position = self.distance_from_line(number, self.uniform(0, 1, number) * period) / period
        return (0.5 * duty - (position - position.floor() - 0.5).abs()) * period

    def _photo(self, number):
        zooms = ((0.6, 1.25), (1.25, 2.2))  # px of a photo per px, by level of the pyramid

        def draw(level, at):
            photos, number = self.pyramid[level], at.stop - at.start
            height, width = photos.shape[1:]
            step = self.log_uniform(*zooms[level], number) / 2**level
            angle = torch.randint(0, 4, (number, 1, 1), device=self.device) * (0.5 * math.pi)
            across, down = self.axis * (2 * self.chance(0.5, number) - 1), self.axis[:, None]
            x = (across * angle.cos() - down * angle.sin()) * step + self.uniform(0, width, number)
            y = (across * angle.sin() + down * angle.cos()) * step + self.uniform(0, height, number)
            source = photos[torch.randint(0, len(photos), (number,), device=self.device)]
            grid = torch.stack([x * 2 / width - 1, y * 2 / height - 1], -1)
            return F.grid_sample(source[:, None], grid, mode="bicubic", padding_mode="reflection", align_corners=False)[:, 0]

        return self._tone(self.by_kind(number, [0.565, 0.435], draw))

    def _tone(self, maps):
        return maps.clamp(0, 1).pow(self.log_uniform(0.7, 2.0, len(maps)))

    def _fractal(self, number):
        total, amplitude, feature = 0.5, 0.25, self.log_uniform(8, 64, number)
        for _ in range(5):
            total = total + amplitude * self.noise(number, feature.clamp_min(1.5))
            amplitude, feature = amplitude * self.uniform(0.5, 0.8, number), feature / 2
        return self._tone(total)

    def _pattern(self, number):
        inside, other = (self._stripes(number, (4, 40), (0.2, 0.8)) for _ in range(2))
        kind = torch.randint(0, 4, (number, 1, 1), device=self.device)
        inside = torch.where(kind == 2, torch.minimum(inside, other), inside)
        inside = torch.where(kind == 3, inside * other.sign(), inside)
        dark, bright = self.uniform(0, 1, number), self.uniform(0, 1, number)
        return dark + (bright - dark) * (inside + 0.5).clamp(0, 1)

    def _shading(self, number):
        shape = self.log_uniform(0.05, 0.5, number) * self.noise(number, self.log_uniform(20, 200, number))
        return self.log_uniform(0.05, 0.8, number) * torch.exp(shape)

    def _plain(self, number):
        return self.uniform(0.02, 1.0, number).expand(-1, self.side, self.side)

    def textures(self, number):
        kinds = [self._photo, self._plain, self._shading, self._fractal, self._pattern]
        maps = self.by_kind(number, [0.6, 0.06, 0.12, 0.12, 0.1], lambda kind, at: kinds[kind](at.stop - at.start))
        maps = maps[torch.randperm(number, device=self.device)]
        weak = self.chance(0.45, number)
        contrast = torch.where(weak > 0, self.log_uniform(0.03, 1.0, number), torch.ones_like(weak))
        mean = maps.mean((1, 2), keepdim=True)
        maps = mean + contrast * (maps - mean) + weak * self.uniform(-0.2, 0.5, number) * (1 - contrast)
        slow = self.noise(number, self.log_uniform(60, 250, number)) * self.log_uniform(0.05, 0.4, number)
        return (maps * torch.exp(self.chance(0.3, number) * slow)).clamp(0, 1)

    def shaded(self, textures):
        """Makes most textures weak, and adds shading and grain as of plaster."""
        number, mean = len(textures), textures.mean((1, 2), keepdim=True)
        contrast = torch.where(self.chance(0.6, number) > 0, self.log_uniform(0.04, 0.6, number), self.uniform(1, 1, number))
        shade = self.chance(0.7, number) * self.noise(number, self.log_uniform(40, 300, number)) * self.log_uniform(0.05, 0.5, number)
        grain = self.chance(0.5, number) * self.noise(number, self.log_uniform(1.5, 6, number)) * self.log_uniform(0.01, 0.12, number)
        return (mean + contrast * (textures - mean)) * torch.exp(shade) * (1 + grain)

    def chequers(self, number):
        """Returns large squares of two brightnesses without texture."""
        period, angle = self.log_uniform(30, 200, number), self.uniform(-0.4, 0.4, number)
        inside = 1
        for across, down in ((angle.cos(), angle.sin()), (-angle.sin(), angle.cos())):
            position = (self.axis * across + self.axis[:, None] * down) / period + self.uniform(0, 1, number)
            inside = inside * ((0.25 - (position - position.floor() - 0.5).abs()) * period).clamp(-0.5, 0.5) * 2
        dark = self.log_uniform(0.02, 0.6, number)
        return dark + (self.uniform(0.05, 1, number) - dark) * (0.5 * inside + 0.5)

    def things(self, number):
        """Returns the distance from the outline, positive inside, of compact things, and y of their lowest points, px."""
        half = 0.5 * self.side
        centre_y, centre_x = (self.uniform(-0.8, 0.8, number) * half for _ in range(2))
        radius_y, radius_x = (self.log_uniform(20, half, number) for _ in range(2))
        radius_x = torch.where(self.chance(0.12, number) > 0, self.log_uniform(2, 8, number), radius_x)  # rods
        y, x = (self.axis[:, None] - centre_y) / radius_y, (self.axis - centre_x) / radius_x
        radius = torch.where(self.chance(0.35, number) > 0, torch.maximum(x.abs(), y.abs()), (x * x + y * y + 1e-6).sqrt())
        uneven = self.noise(number, torch.where(self.chance(0.25, number) > 0, self.log_uniform(2, 8, number), self.log_uniform(20, 100, number)))
        smooth = (1 - radius) * torch.minimum(radius_x, radius_y) + self.chance(0.5, number) * self.log_uniform(1, 10, number) * uneven
        blob = self._in_px(self.noise(number, self.log_uniform(50, 260, number)) - self.uniform(-0.4, 1.0, number))
        return torch.where(self.chance(0.65, number) > 0, smooth, blob), centre_y + radius_y

    def edges(self, inside, sharp_share=0.8, widest_px=6):
        """Returns coverage in [0, 1] for the distance from an outline."""
        number = len(inside)
        edge_px = torch.where(self.chance(sharp_share, number) > 0, self.uniform(1, 1, number), self.log_uniform(1.5, widest_px, number))
        return (inside / edge_px + 0.5).clamp(0, 1)

    def _in_px(self, field):
        """Divides a field of arbitrary units by its mean slope, so that its values near its edges are in px."""
        slope = field.diff(dim=1).abs().mean((1, 2)) + field.diff(dim=2).abs().mean((1, 2))
        return field / (0.7 * slope.view(-1, 1, 1) + 1e-6)

    def coverages(self, textures):
        """Returns the coverage of surfaces: polygons, ellipses and boxes, stripes, blobs, or parts of the texture."""
        number = len(textures)
        inside = self.by_kind(number, [0.2, 0.3, 0.12, 0.26, 0.12], lambda kind, at: self._inside(kind, textures[at]))
        opacity = torch.where(self.chance(0.06, number) > 0, self.uniform(0.3, 0.9, number), self.uniform(1, 1, number))
        return self.edges(inside, 0.75, 8) * opacity

    def _inside(self, kind, textures):
        number, half = len(textures), 0.5 * self.side
        if kind == 0:
            inside = self.distance_from_line(number, self.uniform(-0.7, 0.3, number) * half)
            for _ in range(2):
                unused = 1e4 * self.chance(0.4, number)
                inside = torch.minimum(inside, self.distance_from_line(number, self.uniform(0, 0.8, number) * half) + unused)
            return inside
        if kind == 1:
            radius_y, radius_x = self.log_uniform(4, half, number), self.log_uniform(4, half, number)
            y = (self.axis[:, None] - self.uniform(-0.8, 0.8, number) * half) / radius_y
            x = (self.axis - self.uniform(-0.8, 0.8, number) * half) / radius_x
            box = torch.maximum(x.abs(), y.abs())
            radius = torch.where(self.chance(0.4, number) > 0, box, (x * x + y * y + 1e-6).sqrt())
            return (1 - radius) * torch.minimum(radius_x, radius_y)
        if kind == 2:
            return self._stripes(number, (8, 60), (0.1, 0.6))
        if kind == 3:
            field = self.noise(number, self.log_uniform(6, 90, number)) - self.uniform(-0.3, 1.2, number)
        else:
            spread = textures.std((1, 2), keepdim=True)
            field = textures - textures.mean((1, 2), keepdim=True) - self.uniform(-0.3, 0.8, number) * spread
        return self._in_px(field)

    def reliefs(self, number):
        """Returns smooth deviations of the disparity from a plane."""
        relief = self.noise(number, self.log_uniform(40, 220, number))
        slope = torch.maximum(relief.diff(dim=1).abs().amax((1, 2)), relief.diff(dim=2).abs().amax((1, 2))).view(-1, 1, 1)
        return relief * torch.minimum(self.log_uniform(0.08, 0.9, number), STEEPEST / slope)

    def bulges(self, inside):
        """Returns the deviations of round things: they are nearer in the middle."""
        number = len(inside)
        round_px = self.log_uniform(10, 0.6 * self.side, number)
        from_edge = (inside / round_px).clamp(0, 1)
        return -from_edge * (2 - from_edge) * torch.minimum(self.log_uniform(0.05, 1.5, number), 0.45 * STEEPEST * round_px)


def build_renderer(device):
    source, library = pathlib.Path(__file__).with_name("render.cpp"), pathlib.Path(tempfile.mkdtemp()) / "render.so"
    if device.type == "cuda":
        compiler = [shutil.which("nvcc") or "/usr/local/cuda/bin/nvcc", "-x", "cu", "--use_fast_math", "-arch=native", "-Xcompiler", "-fPIC"]
    else:
        compiler = ["c++", "-march=native", "-ffast-math", "-fPIC"]
    subprocess.run([*compiler, "-O3", "-shared", source, "-o", library], check=True)
    return ctypes.CDLL(str(library))


class Scenes:
    """Scenes of one batch: maps of all layers, and for each scene where its layers begin; from back to front."""

    def __init__(self, renderer, size, planes, maps, reliefs, first):
        self.renderer, self.size, self.planes, self.maps, self.reliefs, self.first = renderer, size, planes, maps, reliefs, first
        self.device = maps.device

    def _render(self, viewpoints, is_disparity):
        number = len(self.first) - 1
        viewpoints = to_device(np.asarray(viewpoints, np.float32), self.device)
        out = torch.empty(number, len(viewpoints), self.size, self.size, device=self.device)
        stream = torch.cuda.current_stream().cuda_stream if self.device.type == "cuda" else None
        at = lambda tensor: ctypes.c_void_p(tensor.data_ptr())
        error = self.renderer.render(number, at(self.planes), at(self.maps), at(self.reliefs), at(self.first), self.reliefs.shape[-1], self.size,
                                     at(viewpoints), len(viewpoints), int(is_disparity), at(out), ctypes.c_void_p(stream))
        if error:
            raise RuntimeError(f"the renderer failed with CUDA error {error}")
        return out

    def views(self, numbers):
        """Returns views in [0, 1], [scene, number, y, x]; the number of a view is 8 row + column."""
        numbers = np.asarray(numbers)
        return self._render(np.stack([numbers // VIEWS - 3.5, numbers % VIEWS - 3.5], 1), False)

    def disparity(self):
        """Returns the disparity of view (4, 4), [scene, y, x], px per view step."""
        return self._render([[0.5, 0.5]], True)[:, 0]


class Synthesiser:
    """Draws scenes whose surfaces are used once: networks learn surfaces by heart that they see again.

    size: height and width of the views in px; max_disparity: in px per view step.
    """

    def __init__(self, photos, size, rng, device, max_disparity=3.2):
        self.size, self.max_disparity, self.rng, self.device = size, max_disparity, rng, device
        self.side = size + 2 * math.ceil(3.5 * max_disparity)
        self.surfaces, self.renderer = Surfaces(photos, self.side, rng, device), build_renderer(device)

    @torch.no_grad()
    def draw(self, number):
        rooms = min(max(int(round(number * ROOM_SHARE + self.rng.uniform(-0.5, 0.5))), 1), number - 1)
        counts = [self.rng.choice(len(shares), n, p=shares) for shares, n in
                  ((PLANE_SHARES, rooms), (THING_SHARES, rooms), (CLUTTER_SHARES, number - rooms))]
        counts[1][0] = max(1, counts[1][0])
        of_planes, of_things, of_clutter = (np.repeat(np.arange(len(count)) + begin, count) for count, begin in zip(counts, (0, 0, rooms)))
        scene = to_device(np.concatenate([np.arange(rooms), of_planes, of_things, of_clutter]), self.device)
        room = self._rooms(rooms, scene[rooms:rooms + len(of_planes)], scene[rooms + len(of_planes):rooms + len(of_planes) + len(of_things)])
        clutter = self._clutter(number, scene[rooms + len(of_planes) + len(of_things):])
        planes, textures, coverages, reliefs, ranks = (torch.cat(pair) for pair in zip(room, clutter))
        order = torch.argsort(1000.0 * scene + 100 * ranks - planes[:, 0])
        maps = torch.stack([textures.clamp(0, 1), coverages], 1)[order]
        maps = F.pad(maps, (BORDER,) * 4, mode="replicate").permute(0, 2, 3, 1).contiguous()
        layers = np.concatenate([1 + counts[0] + counts[1], counts[2]])
        first = to_device(np.concatenate([[0], np.cumsum(layers)]).astype(np.int32), self.device)
        return Scenes(self.renderer, self.size, planes[order].contiguous(), maps, reliefs[order].contiguous(), first)

    def _range(self, number):
        """Returns the largest disparity of scenes, and the smallest: near surfaces have the smaller one."""
        draw = self.surfaces
        scale = torch.tensor([0.15, 0.3, 0.65, 1.0, 1.0], device=self.device)[torch.randint(0, 5, (number, 1, 1), device=self.device)]
        limit = self.max_disparity * scale
        high = draw.uniform(-0.5, 1, number) * limit
        return high, -limit + (high + limit) * draw.uniform(0, 1, number)

    def _slopes(self, centre, share):
        """Returns slopes per px of a share of the surfaces, by which the disparity remains within the limits."""
        draw, number = self.surfaces, len(centre)
        room = ((self.max_disparity - centre.abs()).clamp_min(0) / self.size).clamp_max(0.025)
        return [draw.uniform(-1, 1, number) * room * draw.chance(share, number) for _ in range(2)]

    def _clutter(self, number, scene):
        draw, layers = self.surfaces, len(scene)
        high, low = (values[scene] for values in self._range(number))
        centre = draw.uniform(low, high, layers)
        textures = draw.textures(layers)
        reliefs = draw.reliefs(layers) * draw.chance(0.35, layers)
        return (torch.cat([centre, *self._slopes(centre, 0.6)], 2)[:, 0], textures, draw.coverages(textures), reliefs,
                torch.zeros(layers, device=self.device))

    def _rooms(self, rooms, of_planes, of_things):
        """Returns walls, planes that meet them in a line, most often floors, and things before them, with light from one side."""
        draw, half = self.surfaces, 0.5 * self.side
        number = rooms + len(of_planes) + len(of_things)
        high, low = self._range(rooms)
        wall = torch.cat([high, *self._slopes(high, 0.4)], 2)
        # Planes: the distance from the line where they meet the wall times the slope is added to the wall.
        count = len(of_planes)
        angle = torch.where(draw.chance(0.65, count) > 0, 0.5 * math.pi + draw.uniform(-0.15, 0.15, count), draw.uniform(0, 2 * math.pi, count))
        offset = draw.uniform(-0.7, 0.4, count) * half
        across, down = angle.cos(), angle.sin()
        inside = draw.axis * across + draw.axis[:, None] * down + offset
        of_wall = wall[of_planes]
        farthest = half * (across.abs() + down.abs()) + offset
        steepness = -draw.uniform(0.15, 1, count) * ((of_wall[:, :, :1] + self.max_disparity) / farthest).clamp(0.0005, 0.022)
        planes = torch.cat([of_wall[:, :, :1] + steepness * offset, of_wall[:, :, 1:2] + steepness * down, of_wall[:, :, 2:] + steepness * across], 2)
        # Things stand on a floor or are anywhere before the wall.
        outlines, lowest = draw.things(len(of_things))
        anywhere = draw.uniform(low[of_things], high[of_things], len(of_things))
        floor = torch.full((rooms, 4, 1), 0.0, device=self.device)
        floor[:, :3] = wall.transpose(1, 2)
        floor[of_planes, :3] = planes.transpose(1, 2)
        floor[of_planes, 3] = 1.0 * (down > 0.9)[:, 0]
        floor = floor[of_things]
        at_lowest = floor[:, :1] + floor[:, 1:2] * lowest.clamp(-half, half)
        stands = draw.chance(0.6, len(of_things)) * floor[:, 3:]
        centre = torch.where(stands > 0, at_lowest, torch.minimum(anywhere, torch.where(floor[:, 3:] > 0, at_lowest, anywhere)))
        centre = centre.clamp(-self.max_disparity, self.max_disparity)
        slopes = [0.3 * slope for slope in self._slopes(centre, 0.5)]
        planes = torch.cat([wall, planes, torch.cat([centre, *slopes], 2)])[:, 0]
        reliefs = draw.reliefs(number)
        reliefs[:rooms + count] *= draw.chance(0.15, rooms + count)
        reliefs[rooms + count:] *= 0.6 * draw.chance(0.5, len(of_things))
        reliefs[rooms + count:] += draw.bulges(outlines) * draw.chance(0.7, len(of_things))
        everywhere = torch.ones(rooms, self.side, self.side, device=self.device)
        coverages = torch.cat([everywhere, (inside + 0.5).clamp(0, 1), draw.edges(outlines)])
        scene = torch.cat([torch.arange(rooms, device=self.device), of_planes, of_things])
        textures = draw.shaded(draw.textures(number))
        tiles = (torch.rand(rooms + count, device=self.device) < CHEQUER_SHARE).nonzero()[:, 0]
        if len(tiles):
            textures[tiles] = draw.chequers(len(tiles))
        textures = textures * self._light(reliefs, scene, rooms) * self._shadows(coverages[rooms + count:], of_things, scene, rooms)
        ranks = torch.cat([torch.zeros(rooms, device=self.device), torch.ones(count, device=self.device), torch.full((len(of_things),), 2.0, device=self.device)])
        # A room is as bright as its lamp.
        lamp = torch.where(draw.chance(0.25, rooms) > 0, draw.log_uniform(0.08, 1.0, rooms), draw.uniform(1, 1, rooms))
        return planes, textures * lamp[scene], coverages, reliefs, ranks

    def _light(self, reliefs, scene, rooms):
        """Returns how bright the slopes of reliefs are in a light from one side, and each surface as a whole."""
        draw, number = self.surfaces, len(reliefs)
        angle = draw.uniform(0, 2 * math.pi, rooms)[scene]
        slope_y = F.pad(reliefs.diff(dim=1), (0, 0, 0, 1))
        slope_x = F.pad(reliefs.diff(dim=2), (0, 1))
        strength = draw.log_uniform(1, 12, number)
        return torch.exp((strength * (slope_y * angle.sin() + slope_x * angle.cos())).clamp(-1.2, 0.5)) * draw.log_uniform(0.4, 1.0, number)

    def _shadows(self, coverages, of_things, scene, rooms):
        """Returns the light that the things leave to walls and planes, [layer, y, x]; 1 for the things."""
        draw, number = self.surfaces, len(scene)
        cells = self.side // 8
        small = F.adaptive_avg_pool2d(coverages[:, None], cells)[:, 0]
        shades = torch.zeros(rooms, cells, cells, device=self.device).index_add_(0, of_things, small).clamp(0, 1)
        shades = F.avg_pool2d(shades[:, None], 3, 1, 1)
        axis = torch.linspace(-1, 1, self.side, device=self.device)
        x, y = (axis + draw.uniform(-0.2, 0.2, rooms).view(-1, 1) for _ in range(2))
        grid = torch.stack(torch.broadcast_tensors(x[:, None, :], y[:, :, None]), -1)
        shades = F.grid_sample(shades, grid, mode="bilinear", padding_mode="border", align_corners=False)[:, 0]
        lit = 1 - draw.uniform(0, 0.85, rooms) * draw.chance(0.7, rooms) * shades
        lit = lit[scene]
        lit[number - len(of_things):] = 1
        return lit


class RealScenes:
    """Parts of real light fields at random scales; their disparity was estimated from the true views."""

    def __init__(self, paths, size, rng, device):
        self.size, self.rng, self.scenes = size, rng, []
        for path in paths:
            packed = np.load(path)
            sheet = torch.as_tensor(np.array(Image.open(io.BytesIO(packed["sheet"].tobytes()))))
            height, width = packed["disparity"].shape[1:]
            views = sheet.view(VIEWS, height, VIEWS, width).permute(0, 2, 1, 3).contiguous()
            self.scenes.append((views.to(device), torch.as_tensor(packed["disparity"].astype(np.float32), device=device),
                                torch.as_tensor(packed["is_sure"], device=device)))

    @torch.no_grad()
    def draw(self):
        """Returns views [8, 8, y, x] in [0, 1], the disparity of view (4, 4), and 1 where it is known."""
        rng, size = self.rng, self.size
        views, disparity, is_sure = self.scenes[rng.integers(len(self.scenes))]
        height, width = views.shape[2:]
        part = min(height, width, round(size / math.exp(rng.uniform(math.log(0.7), math.log(2.0)))))
        top, left = rng.integers(height - part + 1), rng.integers(width - part + 1)
        # Mirroring exchanges the views beside the middle; disparities [4] are those of views (3, 3), (3, 4), (4, 3), (4, 4).
        flip_y, flip_x, turn = rng.random(3) < 0.5
        which = 3 - 2 * flip_y - flip_x
        views = views[:, :, top:top + part, left:left + part]
        maps = torch.stack([disparity[which], is_sure[which].float()])[:, top:top + part, left:left + part]
        axes = [k for k, flip in enumerate((flip_y, flip_x)) if flip]
        if axes:
            views, maps = views.flip([*axes, *(axis + 2 for axis in axes)]), maps.flip([axis + 1 for axis in axes])
        if turn:
            views, maps = views.permute(1, 0, 3, 2), maps.transpose(1, 2)
        shrinks = part > size
        views = F.interpolate(views.reshape(1, VIEWS**2, part, part).float() / 255, (size, size), mode="bilinear", antialias=shrinks,
                              align_corners=False)[0]
        maps = F.interpolate(maps[None], (size, size), mode="nearest")[0]
        return views.clamp(0, 1).view(VIEWS, VIEWS, size, size), maps[0] * (size / part), maps[1]


class Batches:
    """Batches without end: views [batch, 64, y, x], the disparity [batch, y, x] of view (4, 4), and 1 where it is known."""

    def __init__(self, photos, real, batch, size, seed, device, real_share=0.15):
        torch.manual_seed(seed)
        self.rng = np.random.default_rng(seed)
        self.synthesiser = Synthesiser(photos, size, self.rng, device)
        self.real = RealScenes(real, size, self.rng, device) if real else None
        self.batch, self.real_share = batch, real_share if real else 0

    @torch.no_grad()
    def next(self):
        num_real = min(int(self.rng.binomial(self.batch, self.real_share)), self.batch - 2)
        scenes = self.synthesiser.draw(self.batch - num_real)
        views, disparity = scenes.views(np.arange(VIEWS**2)), scenes.disparity()
        known = torch.ones_like(disparity)
        if num_real:
            drawn = [self.real.draw() for _ in range(num_real)]
            views = torch.cat([views, torch.stack([v.flatten(0, 1) for v, _, _ in drawn])])
            disparity, known = (torch.cat([a, torch.stack([scene[k] for scene in drawn])]) for a, k in ((disparity, 1), (known, 2)))
        return views, disparity, known
