// A scale of colours with its limits, which may be typed.

class Scale {
  constructor(title, map, changed) {
    Object.assign(this, { title, map: element("canvas"), middle: element("span") });
    drawMap(this.map, map);
    const ofTitle = title ? ` of ${title}` : "";
    this.fields = ["Lower", "Upper"].map((end) => element("input", {
      type: "text", inputmode: "decimal", autocomplete: "off", "aria-label": `${end} limit of the colours${ofTitle}`, oninput: changed }));
    this.node = element("div", { class: "scale", "data-title": title }, title, this.map,
      element("div", { class: "ends" }, this.fields[0], this.middle, this.fields[1]));
  }

  // The limits: typed ones, and automatic ones where the field is empty or wrong.
  limits(automatic) {
    const typed = this.fields.map(({ value }) => (value.trim() === "" ? null : Number(value)));
    const wanted = typed.map((limit, i) => (Number.isFinite(limit) ? limit : automatic[i]));
    const isInOrder = wanted[0] < wanted[1];
    this.fields.forEach((field, i) => {
      const fault = typed[i] === null ? "" : !Number.isFinite(typed[i]) ? "not a number" : isInOrder ? "" : "the lower limit is not below the upper one";
      field.setAttribute("aria-invalid", String(fault !== ""));
      field.title = fault ? `${fault}: the limit is automatic` : "a limit of your own; empty: automatic";
      field.placeholder = number(automatic[i], 3);
    });
    this.shown = isInOrder ? wanted : automatic;
    this.middle.textContent = number((this.shown[0] + this.shown[1]) / 2, 3);
    return this.shown;
  }
}
