// The fragment shaders. `place` is the position in the picture in 0..1, from the top left.
import { nearToFar } from './colour_map';

// A triangle that covers everything. `part` is what is painted of the whole: its left top corner and its size, in 0..1.
export const vertexShader = `#version 300 es
uniform vec4 part;
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  place = part.xy + part.zw * vec2(corner.x, 1.0 - corner.y);
  gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}`;

const lightFields = `#version 300 es
precision highp float;
precision highp sampler2DArray;
out vec4 colour;
uniform sampler2DArray first, second;
uniform bool firstIsGrey, secondIsGrey;
uniform vec2 size;    // of a view, px
uniform float gain, power;
uniform vec2 secondTone;    // gain and black level of the second light field

vec3 sampled(bool isSecond, vec3 at) {
  vec3 value = isSecond ? texture(second, at).rgb : texture(first, at).rgb;
  value = (isSecond ? secondIsGrey : firstIsGrey) ? value.rrr : value;
  return isSecond ? (value - secondTone.y) * secondTone.x : value;
}
vec4 shown(vec3 light) { return vec4(pow(clamp(gain * light, 0.0, 1.0), vec3(power)), 1.0); }
`;

const head = `${lightFields}in vec2 place;
`;

// Dark violet is far, yellow near. Where the confidence is low, only the picture is shown.
const colourOf = `uniform float overlay;    // opacity of the colours of a disparity map; 0 = no map
uniform vec2 overlayRange;
uniform float leastConfidence;
float opacityOf(float confidence) { return confidence < leastConfidence ? 0.0 : 1.0; }
vec3 colourOf(float disparity) {
  float share = clamp((disparity - overlayRange.x) / max(overlayRange.y - overlayRange.x, 1e-6), 0.0, 1.0) * 4.0;
  vec3 stops[5] = vec3[5](${nearToFar.map((stop) => `vec3(${stop.map((value) => (value / 255).toFixed(4))})`).join(', ')});
  int low = min(int(share), 3);
  return mix(stops[low], stops[low + 1], share - float(low));
}
`;

// The colours of a disparity map over the picture of its view.
export const pictureOfMap = `${head}${colourOf}uniform highp sampler2D disparities;
uniform float layer;    // the number of the view
void main() {
  vec3 picture = shown(sampled(false, vec3(place, layer))).rgb;
  vec2 found = texelFetch(disparities, ivec2(place * size), 0).rg;
  colour = vec4(found.r > 1e3 ? picture : mix(picture, colourOf(found.r), overlay * opacityOf(found.g)), 1.0);
}`;

/** The beginning of the shader of reliefs; `layer` is the number of the view on it. */
export const disparityColours = `${lightFields}${colourOf}uniform float layer;
`;

// sum_v w_v L_v(p + d (v - middle)) / sum_v w_v, as lightfield::refocus, with linear interpolation. `taps` holds, for each
// view with some weight: its number, its offset from the middle of the grid (x, y) and its weight.
export const pictureShader = `${head}${colourOf}uniform highp sampler2D taps;
uniform int numTaps;
uniform vec3 focus;    // disparity in the middle, and its change over the width and the height
uniform int mode;      // 0 first, 1 second, 2 swipe, 3 difference
uniform float split, boost;
uniform highp sampler2D disparities;    // px per view of the pixels of one view
uniform vec2 viewpoint, mapView;
uniform bool followsMap;

vec2 foundAt(vec2 p) {
  return texelFetch(disparities, ivec2(clamp(p, vec2(0.0), size - 1.0)), 0).rg;
}
// Returns the point of the view of the map that is at p from the viewpoint: each point is shifted by its own disparity.
vec2 seenAt(vec2 p) {
  vec2 from = p;
  for (int i = 0; i < 4; ++i) {
    float disparity = foundAt(from).r;
    if (disparity > 1e3) break;    // unknown
    from = p - disparity * (viewpoint - mapView);
  }
  return from;
}
vec3 overlaid(vec3 picture, vec2 from) {
  vec2 found = foundAt(from);
  return found.r > 1e3 ? picture : mix(picture, colourOf(found.r), overlay * opacityOf(found.g));
}

// A viewpoint between views is interpolated along the disparities of the map, so that points at all depths are sharp.
vec3 light(bool isSecond, vec2 p, vec2 from) {
  float disparity = focus.x + dot(focus.yz, place - 0.5), found = foundAt(from).r;
  bool follows = followsMap && found < 1e3;
  vec2 around = follows ? viewpoint : vec2(0.0);
  p = follows ? p : place * size;
  vec3 sum = vec3(0.0);
  float weight = 0.0;
  for (int i = 0; i < numTaps; ++i) {
    vec4 tap = texelFetch(taps, ivec2(i, 0), 0);
    sum += tap.w * sampled(isSecond, vec3((p + (follows ? found : disparity) * (tap.yz - around)) / size, tap.x));
    weight += tap.w;
  }
  return sum / weight;
}
void main() {
  vec2 p = place * size + (focus.x + dot(focus.yz, place - 0.5)) * viewpoint, from = seenAt(p);
  if (mode == 3) {
    vec3 difference = light(true, p, from) - light(false, p, from);
    float value = clamp(boost * dot(difference, vec3(0.299, 0.587, 0.114)), -1.0, 1.0);
    // White if both agree, red if the second is brighter, blue if it is darker.
    colour = value > 0.0 ? vec4(1.0, 1.0 - value, 1.0 - value, 1.0) : vec4(1.0 + value, 1.0 + value, 1.0, 1.0);
    return;
  }
  colour = shown(light(mode == 1 || (mode == 2 && place.x >= split), p, from));
  if (overlay > 0.0) colour.rgb = overlaid(colour.rgb, from);
}`;

// A picture enlarged by cubic interpolation (Catmull-Rom), which keeps edges sharper than a linear one.
export const enlargeShader = `${head}
uniform vec2 small;    // size of the picture, px
float weight(float x) {
  x = abs(x);
  return x < 1.0 ? (1.5 * x - 2.5) * x * x + 1.0 : x < 2.0 ? ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0 : 0.0;
}
void main() {
  vec2 p = place * small - 0.5;
  vec2 base = floor(p);
  float sum = 0.0;
  for (int y = -1; y <= 2; ++y) {
    for (int x = -1; x <= 2; ++x) {
      vec2 at = base + vec2(x, y);
      sum += weight(p.x - at.x) * weight(p.y - at.y) * texture(first, vec3((at + 0.5) / small, 0.0)).r;
    }
  }
  colour = vec4(vec3(clamp(sum, 0.0, 1.0)), 1.0);
}`;

// A slice of the light field: views along y and pixels along x, or vice versa.
export const epiShader = `${head}
uniform vec2 grid;     // columns, rows
uniform float fixedView, fixedPixel;
uniform bool isVertical, isSecond;
void main() {
  float along = isVertical ? place.y : place.x, across = isVertical ? place.x : place.y;
  float view = floor(across * (isVertical ? grid.y : grid.x));
  float number = isVertical ? view * grid.x + fixedView : fixedView * grid.x + view;
  vec2 pixel = floor(isVertical ? vec2(fixedPixel, along * size.y) : vec2(along * size.x, fixedPixel));
  vec2 at = (pixel + 0.5) / size;
  colour = shown(sampled(isSecond, vec3(at, number)));
}`;

// All views side by side, separated by dark lines. A pixel of the sheet is the mean over the area that it covers.
export const gridShader = `${head}
uniform vec2 grid, sheet;    // columns and rows; px
uniform bool isSecond;
void main() {
  vec2 cell = floor(place * grid), cellPx = sheet / grid;
  vec2 at = fract(place * grid);
  if (any(lessThan(at * cellPx, vec2(1.0)))) { colour = vec4(vec3(0.05), 1.0); return; }
  ivec2 count = ivec2(clamp(ceil(size / cellPx), 1.0, 8.0));
  vec3 sum = vec3(0.0);
  for (int y = 0; y < count.y; ++y) {
    for (int x = 0; x < count.x; ++x) {
      vec2 part = (vec2(x, y) + 0.5) / vec2(count) - 0.5;
      sum += sampled(isSecond, vec3(at + part / cellPx, cell.y * grid.x + cell.x));
    }
  }
  colour = shown(sum / float(count.x * count.y));
}`;

// The disagreement of the views around a point when they are shifted by a disparity, with one pixel per disparity from
// `low` to `high`: the mean over a window of the variance over the views, as a number of 24 bits.
export const matchShader = `${head}
uniform vec2 grid, centre;    // the point, px
uniform float low, high;
const int reach = 4;
void main() {
  float disparity = mix(low, high, place.x);
  vec2 middle = (grid - 1.0) * 0.5;
  float total = 0.0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      float sum = 0.0, squares = 0.0;
      for (float row = 0.0; row < grid.y; ++row) {
        for (float column = 0.0; column < grid.x; ++column) {
          vec2 p = centre + vec2(dx, dy) + disparity * (vec2(column, row) - middle);
          float value = dot(sampled(false, vec3(p / size, row * grid.x + column)), vec3(0.299, 0.587, 0.114));
          sum += value;
          squares += value * value;
        }
      }
      float views = grid.x * grid.y;
      total += squares / views - (sum / views) * (sum / views);
    }
  }
  float cost = sqrt(max(total, 0.0)) / float(2 * reach + 1) * 2.0;    // a deviation is at most 1/2
  float scaled = floor(clamp(cost, 0.0, 1.0) * 16777215.0);
  colour = vec4(floor(scaled / 65536.0), floor(mod(scaled, 65536.0) / 256.0), mod(scaled, 256.0), 255.0) / 255.0;
}`;
