
"use strict";
// The viewer: two images of the same size on top of each other, with a divider between them.
(() => {
  const element = (id) => document.getElementById(id);
  const data = JSON.parse(element("data").textContent);
  const view = element("view");
  const canvases = { left: element("left-canvas"), right: element("right-canvas") };

  // The value of each half float: sign, 5 bits of exponent, 10 bits of mantissa.
  const HALF = new Float32Array(65536);
  for (let bits = 0; bits < 65536; bits++) {
    const exponent = (bits >> 10) & 31;
    const mantissa = bits & 1023;
    const sign = bits & 32768 ? -1 : 1;
    if (exponent === 31) HALF[bits] = mantissa ? NaN : sign * Infinity;
    else if (exponent === 0) HALF[bits] = sign * mantissa * 2 ** -24;
    else HALF[bits] = sign * (1024 + mantissa) * 2 ** (exponent - 25);
  }

  // The bits of an image's half floats, decoded on first use.
  const halves = (image) => {
    if (!image.bits) {
      const text = atob(image.pixels);
      image.bits = new Uint16Array(text.length / 2);
      for (let i = 0; i < image.bits.length; i++) {
        image.bits[i] = text.charCodeAt(2 * i) | (text.charCodeAt(2 * i + 1) << 8);
      }
      image.pixels = "";
    }
    return image.bits;
  };

  // The transfer function of sRGB (IEC 61966-2-1), to the nearest of 256 steps; NaN becomes 0.
  const srgb = (v) =>
    Math.round(255 * Math.min(Math.max(v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055, 0), 1)) || 0;

  // The pixels of an image at an exposure.
  const exposed = (image, stops) => {
    const factor = image.unit * 2 ** stops;
    const bytes = new Uint8ClampedArray(65536);
    for (let bits = 0; bits < 65536; bits++) bytes[bits] = srgb(HALF[bits] * factor);
    const bits = halves(image);
    return painted(image, (pixel, out, at) => {
      for (let c = 0; c < 3; c++) out[at + c] = bytes[bits[3 * pixel + c]];
    });
  };

  const painted = (image, paint) => {
    const result = new ImageData(image.width, image.height);
    for (let pixel = 0; pixel < image.width * image.height; pixel++) {
      paint(pixel, result.data, 4 * pixel);
      result.data[4 * pixel + 3] = 255;
    }
    return result;
  };

  const mean = (image) => {
    if (image.mean === undefined) {
      const bits = halves(image);
      let sum = 0;
      for (let i = 0; i < bits.length; i++) sum += HALF[bits[i]];
      image.mean = (sum * image.unit) / bits.length;
    }
    return image.mean;
  };

  // The relative error of a pixel: the root of the mean over its channels of
  // (x - r)^2 / (r^2 + 0.01 m^2), where 0/0 = 0.
  const relativeError = (image, reference, pixel) => {
    const [x, r, floor] = [halves(image), halves(reference), 0.01 * mean(reference) ** 2];
    let sum = 0;
    for (let i = 3 * pixel; i < 3 * pixel + 3; i++) {
      const truth = HALF[r[i]] * reference.unit;
      const error = (HALF[x[i]] * image.unit - truth) ** 2;
      sum += error === 0 ? 0 : error / (truth * truth + floor);
    }
    return Math.sqrt(sum / 3);
  };

  // The errors of an image in false colours; NaN is grey.
  const map = (image, reference) => {
    const [low, high] = data.range;
    const last = data.colors.length - 1;
    return painted(image, (pixel, out, at) => {
      const place = Math.log(relativeError(image, reference, pixel) / low) / Math.log(high / low);
      const color = Math.round(last * Math.min(Math.max(place, 0), 1));
      out.set(Number.isNaN(color) ? [128, 128, 128] : data.colors[color], at);
    });
  };

  const chosen = (id) => data.images[element(id).value];
  const sameSize = (a, b) => a.width === b.width && a.height === b.height;

  // Redraws both images.
  const draw = () => {
    const reference = chosen("against");
    const stops = Number(element("exposure").value);
    for (const side of ["left", "right"]) {
      const image = chosen(side);
      const canvas = canvases[side];
      [canvas.width, canvas.height] = [image.width, image.height];
      canvas.getContext("2d").putImageData(reference ? map(image, reference) : exposed(image, stops), 0, 0);
      element(side + "-name").textContent = image.name;
    }
    element("stops").textContent = `${stops > 0 ? "+" : ""}${stops} stop${Math.abs(stops) === 1 ? "" : "s"}`;
    element("exposure").disabled = Boolean(reference);
    element("scale").hidden = !reference;
  };

  // Disables images of another size than the left one.
  const choose = () => {
    const left = chosen("left");
    for (const id of ["right", "against"]) {
      for (const option of element(id).options) {
        const fits = option.value === "" || sameSize(data.images[option.value], left);
        option.disabled = option.hidden = !fits;
      }
      if (element(id).selectedOptions[0].disabled) element(id).value = id === "right" ? element("left").value : "";
    }
    draw();
    layout();
  };

  // The visible part: the zoom relative to the scale that fits the whole image, and the point of the
  // image at the centre of the view.
  const seen = { zoom: 1, x: 0.5, y: 0.5 };
  const MAX_ZOOM = 64;

  const fitting = (image) => Math.min(view.clientWidth / image.width, view.clientHeight / image.height);

  const place = () => {
    const image = chosen("left");
    const scale = fitting(image) * seen.zoom;
    // The centre of the view stays within the image.
    [seen.x, seen.y] = [seen.x, seen.y].map((v) => Math.min(Math.max(v, 0), 1));
    if (seen.zoom === 1) [seen.x, seen.y] = [0.5, 0.5];
    const x = view.clientWidth / 2 - seen.x * image.width * scale;
    const y = view.clientHeight / 2 - seen.y * image.height * scale;
    // The divider is fixed in the view and does not move with the images.
    const split = (element("split").value / 100) * view.clientWidth;
    for (const canvas of Object.values(canvases)) {
      canvas.style.transform = `translate(${x}px, ${y}px) scale(${scale})`;
    }
    canvases.right.style.clipPath = `inset(0 0 0 ${(split - x) / scale}px)`;
    element("divider").style.left = `${split}px`;
    view.classList.toggle("near", seen.zoom > 1);
    return { x, y, scale, split };
  };

  const layout = () => {
    const image = chosen("left");
    view.style.setProperty("--shape", image.width / image.height);
    place();
  };

  // Zooms by a factor; the point of the image at (x, y) of the view is kept there.
  const zoom = (factor, x = view.clientWidth / 2, y = view.clientHeight / 2) => {
    const image = chosen("left");
    const before = place();
    const [u, v] = [(x - before.x) / before.scale, (y - before.y) / before.scale];
    seen.zoom = Math.min(Math.max(seen.zoom * factor, 1), MAX_ZOOM);
    const scale = fitting(image) * seen.zoom;
    seen.x = (u + (view.clientWidth / 2 - x) / scale) / image.width;
    seen.y = (v + (view.clientHeight / 2 - y) / scale) / image.height;
    place();
  };

  const move = (dx, dy) => {
    const image = chosen("left");
    const { scale } = place();
    seen.x -= dx / scale / image.width;
    seen.y -= dy / scale / image.height;
    place();
  };

  const inView = (event) => {
    const box = view.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };

  // A drag near the divider moves it, as does any drag while the whole image is visible; other drags
  // move the images.
  const GRASP = 14;
  let dragged = null;
  view.addEventListener("pointerdown", (event) => {
    const [x] = inView(event);
    dragged = seen.zoom === 1 || Math.abs(x - place().split) < GRASP ? "divider" : "images";
    view.setPointerCapture(event.pointerId);
    drag(event);
  });
  const drag = (event) => {
    if (dragged === "divider") {
      element("split").value = (100 * inView(event)[0]) / view.clientWidth;
      place();
    } else if (dragged === "images") {
      move(event.movementX, event.movementY);
    }
  };
  view.addEventListener("pointermove", (event) => {
    drag(event);
    read(event);
  });
  for (const end of ["pointerup", "pointercancel"]) view.addEventListener(end, () => (dragged = null));

  // The values of the pixel under the pointer.
  const read = (event) => {
    const at = place();
    const [x, y] = inView(event);
    const image = chosen("left");
    const [column, row] = [Math.floor((x - at.x) / at.scale), Math.floor((y - at.y) / at.scale)];
    if (column < 0 || row < 0 || column >= image.width || row >= image.height) return;
    const pixel = row * image.width + column;
    const reference = chosen("against");
    const values = (image) => {
      if (reference) return `${(100 * relativeError(image, reference, pixel)).toPrecision(3)}%`;
      const rgb = [0, 1, 2].map((c) => HALF[halves(image)[3 * pixel + c]] * image.unit);
      return rgb.map((v) => v.toPrecision(3)).join(", ");
    };
    const [left, right] = [image, chosen("right")].map((image) => `${image.name}: ${values(image)}`);
    element("pixel").textContent = `Column ${column}, row ${row}\n${left}; ${right}`;
  };

  view.addEventListener(
    "wheel",
    (event) => {
      // While the whole image is visible, the wheel scrolls the page.
      if (event.deltaY > 0 && seen.zoom === 1) return;
      event.preventDefault();
      zoom(2 ** (-event.deltaY / 300), ...inView(event));
    },
    { passive: false },
  );

  const STEP = 40;
  const keys = {
    ArrowLeft: () => move(STEP, 0),
    ArrowRight: () => move(-STEP, 0),
    ArrowUp: () => move(0, STEP),
    ArrowDown: () => move(0, -STEP),
    "+": () => zoom(1.5),
    "=": () => zoom(1.5),
    "-": () => zoom(1 / 1.5),
    0: () => zoom(0),
  };
  view.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });

  element("in").addEventListener("click", () => zoom(1.5));
  element("out").addEventListener("click", () => zoom(1 / 1.5));
  element("fit").addEventListener("click", () => zoom(0));
  // One pixel of the image per pixel of the screen, if the image is larger than the view.
  element("one").addEventListener("click", () => zoom(1 / place().scale / devicePixelRatio));
  element("split").addEventListener("input", place);
  element("exposure").addEventListener("input", draw);
  element("left").addEventListener("change", choose);
  for (const id of ["right", "against"]) element(id).addEventListener("change", draw);

  element("colors").style.background = `linear-gradient(to right, ${data.colors.map((c) => `rgb(${c})`).join(", ")})`;
  // Resets form values that a browser restores: shows the first image and the next one of its size.
  element("left").value = "0";
  element("against").value = "";
  const next = data.images.findIndex((image, i) => i > 0 && sameSize(image, data.images[0]));
  element("right").value = String(Math.max(next, 0));
  choose();
  new ResizeObserver(place).observe(view);
})();
