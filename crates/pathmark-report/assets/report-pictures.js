"use strict";
// Pictures that are compared: two lie on top of each other with an edge to move, and a map of the left one stands beside them. All zoom and move
// together. They are parts of the sheet that stands on the page anyway, so that nothing is loaded twice.
(() => {
  const MOST_STOPS = 8;
  const HALF_STOP = 0.5;
  const LEAST_ZOOM = 1 / 8;
  const MOST_ZOOM = 64;
  // A step of the wheel, of a key or of a button.
  const ZOOM = 1.25;
  // A step of an arrow key, as a share of what is seen.
  const STEP = 0.1;
  const HELP = "Keys, after a click on the picture: 1 to 9 the left picture, with Shift the right one; e darker, E brighter; + and \u2212 zoom, arrows move; 0 resets. "
    + "Drag to move; the wheel zooms after a click, or with Ctrl. Values are the display values of this page's picture, sRGB from 0 to 255, before the exposure. "
    + "The exposure is computed from these 8-bit values, so white stays white however dark. The PNG file beside the page has the exact pixels.";

  const element = (name, within, text) => {
    const made = document.createElement(name);
    if (text) made.textContent = text;
    within.append(made);
    return made;
  };
  const labelled = (name, text, within) => element(name, element("label", within, `${text} `));
  const within = (value, low, high) => Math.min(high, Math.max(low, value));

  // Light from shares of display values, and back (IEC 61966-2-1).
  const toLight = (share) => (share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4);
  const fromLight = (light) => (light <= 0.0031308 ? light * 12.92 : 1.055 * light ** (1 / 2.4) - 0.055);
  // For each display value the one after so many stops.
  const exposed = (stops) => Uint8ClampedArray.from({ length: 256 }, (_, value) => 255 * fromLight(toLight(value / 255) * 2 ** stops));

  const viewer = (figure, sheet, pictures, maps) => {
    const pixels = document.createElement("canvas");
    [pixels.width, pixels.height] = [sheet.naturalWidth, sheet.naturalHeight];
    const source = pixels.getContext("2d", { willReadFrequently: true });
    source.drawImage(sheet, 0, 0);

    const view = element("div", figure);
    view.className = "viewer";
    view.tabIndex = 0;
    view.setAttribute("role", "group");
    view.setAttribute("aria-label", "Compare the pictures");
    const controls = element("div", view);
    controls.className = "controls";
    const stage = element("div", view);
    stage.className = "stage";
    const value = element("p", view);
    value.className = "value";
    value.setAttribute("role", "status");
    element("p", view, HELP).className = "help";

    // Where all look: the middle as shares of a picture, and how often it fits into the width.
    const look = { zoom: 1, x: 0.5, y: 0.5, edge: 0.5, stops: 0 };
    const range = (name, key, low, high, step) => {
      const input = labelled("input", name, controls);
      Object.assign(input, { type: "range", min: low, max: high, step });
      input.addEventListener("input", () => {
        look[key] = Number(input.value);
        redraw();
      });
      return input;
    };
    const chooser = (name, options) => {
      const choice = labelled("select", name, controls);
      options.forEach(([text, of]) => choice.append(new Option(text, of)));
      choice.addEventListener("input", () => redraw());
      return choice;
    };
    const pane = () => {
      const part = element("div", stage);
      part.className = "pane";
      return { part, caption: element("p", part), canvas: element("canvas", part) };
    };

    const names = pictures.map((image, place) => [`${place + 1}: ${image.caption[0]}`, place]);
    const [left, right] = [chooser("Left", names), chooser("Right", names)];
    right.value = String(pictures.length - 1);
    // Maps of errors come first: the reference has none, but every picture has a part with all pixels.
    const countOf = (name) => maps.filter((image) => image.caption[0] === name).length;
    const kinds = [...new Set(maps.map((image) => image.caption[0]))].sort((a, b) => countOf(a) - countOf(b));
    const kind = kinds.length > 0 ? chooser("Beside", [...kinds, "nothing"].map((name) => [name, name])) : null;
    const edge = range("Edge", "edge", 0, 1, 0.01);
    const exposure = range("Exposure", "stops", -MOST_STOPS, MOST_STOPS, HALF_STOP);
    const stops = element("output", exposure.parentElement);
    const main = pane();
    const beside = kind ? pane() : null;

    const paint = (canvas, image, from, to) => {
      const context = canvas.getContext("2d");
      const [x, y, wide, high] = image.area;
      const scale = (look.zoom * canvas.width) / wide;
      context.save();
      context.beginPath();
      context.rect(from * canvas.width, 0, (to - from) * canvas.width, canvas.height);
      context.clip();
      context.imageSmoothingEnabled = false;
      context.setTransform(scale, 0, 0, scale, canvas.width / 2 - look.x * wide * scale, canvas.height / 2 - look.y * high * scale);
      context.drawImage(sheet, x, y, wide, high, 0, 0, wide, high);
      context.restore();
    };
    // A canvas in the pixels of the screen, with the shape of an image.
    const size = (canvas, image) => {
      canvas.width = Math.round((canvas.clientWidth || 480) * (window.devicePixelRatio || 1));
      canvas.height = Math.round((canvas.width * image.area[3]) / image.area[2]);
    };
    const expose = (canvas) => {
      if (look.stops === 0) return;
      const context = canvas.getContext("2d");
      const image = context.getImageData(0, 0, canvas.width, canvas.height);
      const table = exposed(look.stops);
      // Every fourth byte is the opacity.
      image.data.forEach((byte, place) => { if (place % 4 !== 3) image.data[place] = table[byte]; });
      context.putImageData(image, 0, 0);
    };
    const chosen = (choice) => pictures[Number(choice.value)];
    const redraw = () => {
      const [a, b] = [chosen(left), chosen(right)];
      [look.x, look.y] = [within(look.x, 0, 1), within(look.y, 0, 1)];
      [edge.value, exposure.value] = [look.edge, look.stops];
      stops.textContent = ` ${look.stops > 0 ? "+" : ""}${look.stops} stops`;
      size(main.canvas, a);
      paint(main.canvas, a, 0, look.edge);
      paint(main.canvas, b, look.edge, 1);
      expose(main.canvas);
      if (look.edge > 0 && look.edge < 1) {
        const context = main.canvas.getContext("2d");
        context.fillStyle = "#d55e00";
        context.fillRect(look.edge * main.canvas.width - 1, 0, 2, main.canvas.height);
      }
      main.caption.textContent = `Left ${a.caption.join(", ")}; right ${b.caption.join(", ")}`;
      if (!beside) return;
      const map = maps.find((image) => image.column === a.column && image.caption[0] === kind.value);
      beside.part.hidden = !map;
      if (!map) return;
      size(beside.canvas, map);
      paint(beside.canvas, map, 0, 1);
      beside.caption.textContent = `Of the left one: ${map.caption.join(", ")}`;
    };

    // The point of the canvas at `at`, given by shares, stays where it is.
    const zoom = (factor, at = [0.5, 0.5]) => {
      const next = within(look.zoom * factor, LEAST_ZOOM, MOST_ZOOM);
      const moved = 1 / look.zoom - 1 / next;
      look.x += (at[0] - 0.5) * moved;
      look.y += (at[1] - 0.5) * moved;
      look.zoom = next;
      redraw();
    };
    const move = (x, y) => {
      look.x += x / look.zoom;
      look.y += y / look.zoom;
      redraw();
    };
    const expand = (by) => {
      look.stops = within(look.stops + by, -MOST_STOPS, MOST_STOPS);
      redraw();
    };
    const reset = () => {
      Object.assign(look, { zoom: 1, x: 0.5, y: 0.5, edge: 0.5, stops: 0 });
      redraw();
    };
    addButton(controls, "+", () => zoom(ZOOM));
    addButton(controls, "\u2212", () => zoom(1 / ZOOM));
    addButton(controls, "1:1", () => {
      // A pixel of the sheet on each pixel of the page.
      look.zoom = (chosen(left).area[2] * (window.devicePixelRatio || 1)) / main.canvas.width;
      redraw();
    });
    addButton(controls, "Reset", reset);

    const shares = (canvas, event) => {
      const box = canvas.getBoundingClientRect();
      return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    };
    // Column and row of an image below a point of a canvas, and its display value; nothing outside.
    const read = (image, at) => {
      const [x, y, wide, high] = image.area;
      const [u, v] = [look.x + (at[0] - 0.5) / look.zoom, look.y + (at[1] - 0.5) / look.zoom];
      const [column, row] = [Math.floor(u * wide), Math.floor(v * high)];
      if (column < 0 || row < 0 || column >= wide || row >= high) return null;
      const [red, green, blue] = source.getImageData(x + column, y + row, 1, 1).data;
      return { place: `column ${column}, row ${row}`, colour: `${red} ${green} ${blue}` };
    };
    [main, beside].filter(Boolean).forEach(({ canvas }) => {
      canvas.addEventListener("pointermove", (event) => {
        if (event.buttons) {
          move(-event.movementX / canvas.clientWidth, -event.movementY / canvas.clientHeight);
          return;
        }
        const [a, b] = [left, right].map((choice) => read(chosen(choice), shares(canvas, event)));
        value.textContent = a && b ? `${a.place}: left ${a.colour}, right ${b.colour}` : "";
      });
      canvas.addEventListener("wheel", (event) => {
        // Otherwise the page scrolls, as everywhere.
        if (!event.ctrlKey && !view.contains(document.activeElement)) return;
        event.preventDefault();
        zoom(event.deltaY > 0 ? 1 / ZOOM : ZOOM, shares(canvas, event));
      }, { passive: false });
    });
    const acts = {
      "+": () => zoom(ZOOM),
      "=": () => zoom(ZOOM),
      "-": () => zoom(1 / ZOOM),
      e: () => expand(-HALF_STOP),
      E: () => expand(HALF_STOP),
      0: reset,
      ArrowLeft: () => move(-STEP, 0),
      ArrowRight: () => move(STEP, 0),
      ArrowUp: () => move(0, -STEP),
      ArrowDown: () => move(0, STEP),
    };
    view.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("select, input")) return;
      const act = Object.hasOwn(acts, event.key) ? acts[event.key] : null;
      const digit = /^Digit([1-9])$/.exec(event.shiftKey ? event.code : `Digit${event.key}`);
      if (!act && !(digit && digit[1] <= pictures.length)) return;
      event.preventDefault();
      if (act) {
        act();
        return;
      }
      (event.shiftKey ? right : left).value = String(digit[1] - 1);
      redraw();
    });
    window.addEventListener("resize", redraw);
    redraw();
  };

  document.querySelectorAll("figure.sheet").forEach((figure) => {
    const [comparison, images] = JSON.parse(figure.querySelector("script.images").textContent);
    const sheet = figure.querySelector("img");
    if (comparison === "single" || images.length < 2) return;
    // The first row of steps has the pictures, and the others have maps of them.
    const pictures = comparison === "steps" ? images.filter((image) => image.row === 0) : images;
    const maps = images.filter((image) => !pictures.includes(image));
    const build = () => viewer(figure, sheet, pictures, maps);
    if (sheet.complete) build(); else sheet.addEventListener("load", build);
  });
})();
