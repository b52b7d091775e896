"use strict";
// Pictures that are compared: a slider over the steps of a render, an edge that wipes between two images, and a magnifier. The images are parts of
// the sheet that stands on the page anyway, so that nothing is loaded twice.
(() => {
  const ZOOMS = [1, 2, 4, 8];

  const element = (name, within, text) => {
    const made = document.createElement(name);
    if (text) made.textContent = text;
    within.append(made);
    return made;
  };
  const labelled = (name, text, within) => {
    const label = element("label", within, `${text} `);
    return element(name, label);
  };

  const viewer = (figure, sheet, comparison, images) => {
    const view = document.createElement("div");
    view.className = "viewer";
    const controls = element("div", view);
    controls.className = "controls";
    const stage = element("div", view);
    stage.className = "stage";
    const [, , width, height] = images[0].area;
    // Where the magnifier looks, as shares of the image.
    const look = { zoom: 1, x: 0.5, y: 0.5 };
    const panes = [];

    const draw = (canvas, image) => {
      const context = canvas.getContext("2d");
      context.clearRect(0, 0, canvas.width, canvas.height);
      if (!image) return;
      const [left, top, wide, high] = image.area;
      const [w, h] = [wide / look.zoom, high / look.zoom];
      const x = Math.min(Math.max(look.x * wide - w / 2, 0), wide - w);
      const y = Math.min(Math.max(look.y * high - h / 2, 0), high - h);
      context.imageSmoothingEnabled = false;
      context.drawImage(sheet, left + x, top + y, w, h, 0, 0, canvas.width, canvas.height);
    };
    const pane = (within) => {
      const part = element("div", within);
      part.className = "pane";
      const caption = element("p", part);
      const canvas = element("canvas", part);
      [canvas.width, canvas.height] = [2 * width, 2 * height];
      canvas.addEventListener("pointermove", (event) => {
        if (!event.buttons) return;
        look.x = Math.min(1, Math.max(0, look.x - event.movementX / canvas.clientWidth / look.zoom));
        look.y = Math.min(1, Math.max(0, look.y - event.movementY / canvas.clientHeight / look.zoom));
        redraw();
      });
      const own = { part, caption, canvas, image: null };
      panes.push(own);
      return own;
    };
    const redraw = () => panes.forEach(({ caption, canvas, image, part }) => {
      part.hidden = !image;
      caption.textContent = image ? image.caption.join("  ·  ") : "";
      draw(canvas, image);
    });

    if (comparison === "steps") {
      const rows = [...new Set(images.map((image) => image.row))];
      const columns = [...new Set(images.map((image) => image.column))];
      const slider = labelled("input", "Step", controls);
      Object.assign(slider, { type: "range", min: 0, max: columns.length - 1, value: 0 });
      rows.forEach(() => pane(stage));
      const step = () => {
        const column = columns[Number(slider.value)];
        rows.forEach((row, place) => {
          panes[place].image = images.find((image) => image.row === row && image.column === column) || null;
        });
        slider.setAttribute("aria-valuetext", panes[0].image ? panes[0].image.caption.join(", ") : "");
        redraw();
      };
      slider.addEventListener("input", step);
      step();
    } else {
      const choices = ["Left", "Right"].map((name) => labelled("select", name, controls));
      choices.forEach((choice) => images.forEach((image, place) => choice.append(new Option(image.caption[0], place))));
      choices[1].value = String(images.length - 1);
      const edge = labelled("input", "Edge", controls);
      Object.assign(edge, { type: "range", min: 0, max: 100, value: 50 });
      stage.classList.add("wipe");
      choices.forEach(() => pane(stage));
      const compare = () => {
        choices.forEach((choice, place) => { panes[place].image = images[Number(choice.value)]; });
        // The right image lies over the left one and is cut at the edge.
        panes[1].canvas.style.clipPath = `inset(0 0 0 ${edge.value}%)`;
        redraw();
      };
      [...choices, edge].forEach((input) => input.addEventListener("input", compare));
      compare();
    }
    const zoom = labelled("select", "Magnify", controls);
    ZOOMS.forEach((times) => zoom.append(new Option(`${times} ×`, times)));
    zoom.addEventListener("input", () => {
      look.zoom = Number(zoom.value);
      redraw();
    });
    figure.append(view);
  };

  document.querySelectorAll("figure.sheet").forEach((figure) => {
    const [comparison, images] = JSON.parse(figure.querySelector("script.images").textContent);
    const sheet = figure.querySelector("img");
    if (comparison === "single" || images.length < 2) return;
    const build = () => viewer(figure, sheet, comparison, images);
    if (sheet.complete) build(); else sheet.addEventListener("load", build);
  });
})();
