"""Light fields of layered scenes with known disparity, rendered in batches on the device of training."""
import math

import numpy as np
import torch
import torch.nn.functional as F

VIEWS = 8
CENTRAL = [(3, 3), (3, 4), (4, 3), (4, 4)]  # the views that a flip turns into view (4, 4)


class Synthesiser:
    """Draws scenes of up to six textured surfaces, slanted or curved, of which many have weak texture or none.

    photos: uint8 [number, y, x], textures in addition to procedural ones.
    size: height and width of the views in px; max_disparity: in px per view step.
    """

    def __init__(self, photos, size, max_disparity=3.2, seed=1):
        self.size, self.max_disparity, self.device = size, max_disparity, photos.device
        self.side = size + 2 * math.ceil(3.5 * max_disparity)
        self.pyramid = [photos.float().div(255)]
        self.pyramid.append(F.avg_pool2d(self.pyramid[0][:, None], 2)[:, 0])
        self.rng = np.random.default_rng(seed)
        self.axis = torch.arange(self.side, device=self.device).float() - 0.5 * (self.side - 1)

    # Draws, shaped to be multiplied with maps [number, y, x].
    def _maps(self, values):
        return torch.as_tensor(np.asarray(values, np.float32), device=self.device).view(-1, 1, 1)

    def _uniform(self, low, high, number):
        return self._maps(self.rng.uniform(low, high, number))

    def _log_uniform(self, low, high, number):
        return self._maps(np.exp(self.rng.uniform(math.log(low), math.log(high), number)))

    def _chance(self, probability, number):
        return self._maps(self.rng.random(number) < probability)

    def _noise(self, number, feature_px):
        """Returns smooth noise of unit variance with features of feature_px [number, 1, 1]."""
        cells = 64
        noise = torch.randn(number, 1, cells, cells, device=self.device)
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
        maps = torch.empty(number, self.side, self.side, device=self.device)
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
            source = photos[torch.as_tensor(self.rng.integers(0, len(photos), len(chosen)), device=self.device)]
            grid = torch.stack([x * 2 / width - 1, y * 2 / height - 1], -1)
            maps[torch.as_tensor(chosen, device=self.device)] = F.grid_sample(
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
        maps = torch.empty(number, self.side, self.side, device=self.device)
        for k, draw in enumerate(kinds):
            chosen = np.nonzero(kind == k)[0]
            if len(chosen):
                maps[torch.as_tensor(chosen, device=self.device)] = draw(len(chosen))
        weak = self._chance(0.45, number)
        contrast = torch.where(weak > 0, self._log_uniform(0.03, 1.0, number), torch.ones_like(weak))
        mean = maps.mean((1, 2), keepdim=True)
        maps = mean + contrast * (maps - mean) + weak * self._uniform(-0.2, 0.5, number) * (1 - contrast)
        slow = self._noise(number, self._log_uniform(60, 250, number)) * self._log_uniform(0.05, 0.4, number)
        return (maps * torch.exp(self._chance(0.3, number) * slow)).clamp(0, 1)

    def _coverages(self, textures):
        """Returns the opacity of surfaces: polygons, ellipses and boxes, stripes, blobs, or parts of the texture."""
        number, half = len(textures), 0.5 * self.side
        kind = self.rng.choice(5, number, p=[0.2, 0.3, 0.12, 0.26, 0.12])
        inside = torch.empty_like(textures)
        for k in range(5):
            chosen = np.nonzero(kind == k)[0]
            if len(chosen):
                at = torch.as_tensor(chosen, device=self.device)
                inside[at] = self._inside(k, len(chosen), textures[at], half)
        edge_px = torch.where(self._chance(0.75, number) > 0, torch.ones(1, device=self.device), self._log_uniform(1.5, 8, number))
        opacity = torch.where(self._chance(0.06, number) > 0, self._uniform(0.3, 0.9, number), torch.ones(1, device=self.device))
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
        slope = field.diff(dim=1).abs().mean((1, 2)) + field.diff(dim=2).abs().mean((1, 2))
        return field / (0.7 * slope.view(-1, 1, 1) + 1e-6)

    def _surfaces(self, number, layers):
        """Returns disparity, slopes per px and curvature per px^2 of surfaces from back to front, each [number, layers]."""
        rng, shape = self.rng, (number, layers)
        limit = self.max_disparity * rng.choice([0.3, 0.65, 1.0, 1.0], number)
        high = rng.uniform(-0.5, 1, number) * limit
        low = -limit + rng.random(number) * (high + limit)
        centre = -np.sort(-rng.uniform(low[:, None], high[:, None], shape), axis=1)
        room = np.maximum(self.max_disparity - np.abs(centre), 0) / self.size
        slopes = [rng.uniform(-1, 1, shape) * np.minimum(room, 0.025) * (rng.random(shape) < 0.6) for _ in range(2)]
        most = 0.5 * np.minimum(room * self.size, 0.8) / (0.5 * self.size) ** 2
        curvature = rng.uniform(-1, 1, shape) * most * (rng.random(shape) < 0.25)
        return [torch.as_tensor(values, dtype=torch.float32, device=self.device) for values in (centre, *slopes, curvature)]

    @torch.no_grad()
    def scenes(self, number, layers):
        """Returns views in [0, 1], [number, 64, y, x], and the disparities [number, 4, y, x] of the views CENTRAL."""
        size, side = self.size, self.side
        surfaces = self._surfaces(number, layers)
        textures = self._textures(number * layers)
        coverages = self._coverages(textures).view(number, layers, side, side)
        coverages[:, 0] = 1
        maps = torch.stack([textures.view(number, layers, side, side), coverages], 2)
        pixel = torch.arange(size, device=self.device).float() - 0.5 * (size - 1)
        view = torch.arange(VIEWS, device=self.device).float() - 0.5 * (VIEWS - 1)
        y, x = pixel.view(size, 1), pixel
        view_y, view_x = view.repeat_interleave(VIEWS).view(1, -1, 1, 1), view.repeat(VIEWS).view(1, -1, 1, 1)
        central = [VIEWS * row + column for row, column in CENTRAL]
        for layer in range(layers):
            centre, slope_y, slope_x, curvature = (values[:, layer].view(-1, 1, 1, 1) for values in surfaces)
            disparity = (centre + slope_y * y + slope_x * x) / (1 + slope_y * view_y + slope_x * view_x)
            for _ in range(3):  # the point that is seen: q = p - view * d(q)
                at_y, at_x = y - view_y * disparity, x - view_x * disparity
                disparity = centre + slope_y * at_y + slope_x * at_x + curvature * (at_y * at_y + at_x * at_x)
            grid = torch.stack([(x - view_x * disparity) * (2 / side), (y - view_y * disparity) * (2 / side)], -1)
            seen = F.grid_sample(maps[:, layer], grid.view(number, -1, size, 2), mode="bicubic", padding_mode="border",
                                 align_corners=False).view(number, 2, VIEWS**2, size, size)
            if layer == 0:
                views, nearest = seen[:, 0], disparity[:, central].clone()
                continue
            opacity = seen[:, 1].clamp(0, 1)
            views = torch.lerp(views, seen[:, 0], opacity)
            nearest = torch.where(opacity[:, central] > 0.5, disparity[:, central], nearest)
        return views.clamp(0, 1), nearest


class Pool:
    """Scenes for training, of which each is replaced after a few uses: with more uses, networks learn the scenes by heart.

    layers: their possible numbers of layers; uses: how often a scene is drawn, on average.
    """

    def __init__(self, synthesiser, number, uses=3, chunk=8):
        size, device = synthesiser.size, synthesiser.device
        self.synthesiser, self.uses, self.chunk, self.made, self.drawn = synthesiser, uses, chunk, 0, 0
        self.views = torch.empty(number, VIEWS**2, size, size, dtype=torch.uint8, device=device)
        self.disparities = torch.empty(number, len(CENTRAL), size, size, dtype=torch.float16, device=device)
        while self.made < number:
            self._render()

    def _render(self):
        layers = int(self.synthesiser.rng.choice(6, p=[0.08, 0.15, 0.2, 0.2, 0.2, 0.17])) + 1
        views, disparities = self.synthesiser.scenes(self.chunk, layers)
        at = torch.arange(self.made, self.made + self.chunk, device=views.device) % len(self.views)
        self.views[at] = (views * 255).round().to(torch.uint8)
        self.disparities[at] = disparities.half()
        self.made += self.chunk

    def draw(self, batch, patch):
        """Returns views in [0, 1], [batch, 64, patch, patch], and the disparity [batch, patch, patch] of view (4, 4)."""
        rng = self.synthesiser.rng
        self.drawn += batch
        while self.drawn > self.uses * (self.made - len(self.views)) + self.uses * self.chunk:
            self._render()
        chosen = torch.as_tensor(rng.integers(0, len(self.views), batch), device=self.views.device)
        top, left = rng.integers(0, self.views.shape[2] - patch + 1, 2)
        views = self.views[:, :, top:top + patch, left:left + patch][chosen].float().div(255)
        disparities = self.disparities[:, :, top:top + patch, left:left + patch][chosen].float()
        return flip(views, disparities, rng.integers(0, 8))


def flip(views, disparities, symmetry):
    """Flips and transposes views and pixels alike, which keeps the sign of the disparity."""
    batch, _, height, width = views.shape
    views = views.view(batch, VIEWS, VIEWS, height, width)
    of_view = 3
    if symmetry & 1:
        views, disparities, of_view = views.flip(1, 3), disparities.flip(2), of_view ^ 2
    if symmetry & 2:
        views, disparities, of_view = views.flip(2, 4), disparities.flip(3), of_view ^ 1
    disparity = disparities[:, of_view]
    if symmetry & 4:
        views, disparity = views.permute(0, 2, 1, 4, 3), disparity.transpose(1, 2)
    return views.reshape(batch, VIEWS**2, *views.shape[3:]), disparity
