"use strict";
// The page is complete without this script: it adds values under the pointer, lines that can be switched off, downloads and sorting.

// For this script and those behind it.
const all = (selector, within = document) => Array.from(within.querySelectorAll(selector));
const save = (blob, name) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};
const addButton = (within, label, act) => {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = label;
  made.addEventListener("click", act);
  within.append(made);
  return made;
};

(() => {
  // Narrow screens begin with a closed table of contents.
  if (window.matchMedia("(max-width: 79.99rem)").matches) {
    all("nav details").forEach((contents) => { contents.open = false; });
  }

  // Values under the pointer, or under a finger.
  const value = document.createElement("div");
  value.id = "value";
  value.hidden = true;
  value.setAttribute("role", "status");
  document.body.append(value);
  // The values of figures stand on the page in a short form. A figure on other axes has the places of its values alone.
  all("figure").forEach((figure) => {
    const [first, other] = all("svg", figure).map((svg) => all("circle.note", svg));
    [...(first || []), ...(other || [])].filter((note) => note.dataset.note !== undefined).forEach((note) => {
      const [value, low, high, count, ...of] = note.dataset.note.split("|");
      Object.assign(note.dataset, { series: note.parentElement.dataset.series, value, low, high, count, of: of.join("|") });
      // The browser's own tooltip comes late and not at all for a finger.
      const title = note.querySelector("title");
      note.setAttribute("aria-label", title.textContent);
      title.remove();
    });
    (other || []).filter((note) => note.dataset.note === undefined).forEach((note, place) => {
      Object.assign(note.dataset, first[place].dataset);
      note.setAttribute("aria-label", first[place].getAttribute("aria-label"));
    });
  });
  const addLine = (text) => {
    const line = document.createElement("div");
    line.textContent = text;
    value.append(line);
  };
  // The command that runs what a value stands for: the experiment, with a filter for each name of the series and of the place.
  const commandOf = (note) => {
    const section = note.closest("section[data-again]");
    if (!section) return "";
    // Every part is quoted for a shell already.
    const again = JSON.parse(section.dataset.again);
    const names = `${note.dataset.series}, ${note.dataset.of}`.split(/,\s|:\s|\s\+\s/);
    const filters = names.filter((name) => Object.hasOwn(again.filters, name)).map((name) => again.filters[name]);
    return [again.run, ...new Set(filters), again.out].join(" ");
  };
  const showNote = (note, x, y) => {
    value.hidden = !note;
    if (!note) return;
    value.textContent = note.getAttribute("aria-label");
    const count = Number(note.dataset.count);
    if (count > 0) addLine(count === 1 ? "one value" : `${count} values`);
    const command = commandOf(note);
    if (command) addLine(command);
    const left = Math.min(x + 14, window.innerWidth - value.offsetWidth - 8);
    value.style.left = `${Math.max(8, left)}px`;
    value.style.top = `${Math.max(8, y - value.offsetHeight - 12)}px`;
  };
  const show = (event) => {
    const note = event.target.closest ? event.target.closest("circle.note") : null;
    showNote(note, event.clientX, event.clientY);
  };
  // By keyboard: the arrow keys go from value to value of the figure that has the focus.
  all("figure > svg, figure > .other > svg").forEach((svg) => {
    const notes = all("circle.note", svg);
    if (notes.length === 0) return;
    let place = -1;
    svg.setAttribute("tabindex", "0");
    svg.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      place = (place + step + notes.length) % notes.length;
      const box = notes[place].getBoundingClientRect();
      showNote(notes[place], box.left + box.width / 2, box.top);
    });
    svg.addEventListener("blur", () => { value.hidden = true; });
  });
  document.addEventListener("pointermove", show);
  document.addEventListener("click", show);

  // A click on an entry of a legend switches its series off and on.
  all("figure svg").forEach((svg) => {
    const named = (selector, name) => all(selector, svg).filter((part) => part.dataset.series === name);
    all("g.legend", svg).forEach((entry) => {
      const parts = named("g.series", entry.dataset.series);
      if (parts.length === 0) return;
      const turn = () => {
        const off = entry.classList.toggle("is-off");
        entry.setAttribute("aria-pressed", String(!off));
        parts.forEach((part) => part.classList.toggle("is-off", off));
        named("circle.note", entry.dataset.series).forEach((note) => { note.style.display = off ? "none" : ""; });
      };
      entry.setAttribute("tabindex", "0");
      entry.setAttribute("role", "button");
      entry.setAttribute("aria-label", `Line ${entry.dataset.series}`);
      entry.setAttribute("aria-pressed", "true");
      entry.addEventListener("click", turn);
      entry.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        event.stopPropagation();
        turn();
      });
    });
  });

  // Downloads.
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  // A figure by itself has the style sheet of all figures, with the colours on white paper.
  const asSvg = (svg) => {
    const copy = svg.cloneNode(true);
    const style = document.createElementNS("http://www.w3.org/2000/svg", "style");
    style.textContent = `${document.getElementById("figure-style").textContent} text { font-family: "DejaVu Sans", sans-serif; }`;
    copy.prepend(style);
    return new Blob([new XMLSerializer().serializeToString(copy)], { type: "image/svg+xml" });
  };
  const asCsv = (svg) => {
    const keys = ["series", "of", "value", "low", "high", "count"];
    const rows = all("circle.note", svg).map((note) => keys.map((key) => quoted(note.dataset[key] || "")).join(","));
    return new Blob([[keys.join(","), ...rows].join("\n") + "\n"], { type: "text/csv" });
  };
  const asPng = (svg, done) => {
    const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
    const picture = new Image();
    picture.onload = () => {
      const canvas = document.createElement("canvas");
      canvas.width = width;
      canvas.height = height;
      canvas.getContext("2d").drawImage(picture, 0, 0, width, height);
      URL.revokeObjectURL(picture.src);
      canvas.toBlob(done);
    };
    picture.src = URL.createObjectURL(asSvg(svg));
  };
  all("figure").forEach((figure) => {
    if (!figure.querySelector("svg")) return;
    const shown = () => all("svg", figure).find((svg) => !svg.closest("[hidden]") && svg.style.display !== "none");
    const tools = document.createElement("div");
    tools.className = "tools";
    const button = (label, act) => addButton(tools, label, act);
    button("SVG", () => save(asSvg(shown()), `${figure.id}.svg`));
    button("PNG", () => asPng(shown(), (blob) => save(blob, `${figure.id}.png`)));
    if (figure.querySelector("circle.note")) button("CSV", () => save(asCsv(shown()), `${figure.id}.csv`));
    const other = figure.querySelector(".other");
    if (other) {
      const first = figure.querySelector("svg");
      const names = [other.dataset.name, other.dataset.name === "linear axes" ? "logarithmic axes" : "linear axes"];
      const made = button(names[0], () => {
        other.hidden = !other.hidden;
        first.style.display = other.hidden ? "" : "none";
        made.textContent = names[other.hidden ? 0 : 1];
      });
      first.after(other);
    }
    figure.append(tools);
  });

  // Tables sort by the column whose head is clicked; a second click turns the order around.
  const key = (row, column) => {
    const text = row.cells[column] ? row.cells[column].textContent.trim().replace("\u2212", "-") : "";
    const number = parseFloat(text);
    return [Number.isFinite(number) ? number : Infinity, text];
  };
  all("main table").forEach((table) => {
    const body = table.tBodies[0];
    if (!table.tHead || !body) return;
    const heads = Array.from(table.tHead.rows[0].cells);
    // Narrow screens show a row as a card, with the head of each column before its cell.
    Array.from(body.rows).forEach((row) => Array.from(row.cells).forEach((cell, column) => {
      if (heads[column]) cell.dataset.head = heads[column].textContent;
    }));
    heads.forEach((head, column) => {
      const sorter = document.createElement("button");
      sorter.type = "button";
      sorter.textContent = head.textContent;
      head.replaceChildren(sorter);
      sorter.addEventListener("click", () => {
        const up = head.getAttribute("aria-sort") !== "ascending";
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", up ? "ascending" : "descending");
        const rows = Array.from(body.rows).map((row) => [key(row, column), row]);
        rows.sort(([[a, left]], [[b, right]]) => (a === b ? left.localeCompare(right) : a - b) * (up ? 1 : -1));
        body.append(...rows.map(([, row]) => row));
      });
    });
  });
})();
