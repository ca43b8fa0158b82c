// The few DOM helpers that the views share. Writing is always conditional:
// an unchanged text or attribute costs no mutation, and a screen reader hears
// no repetition.

type Attribute = string | number | boolean | undefined | ((event: never) => void);
type Child = Node | string | null;

/** Creates an element. Keys with "on" add listeners; false and undefined attributes are left out. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Record<string, Attribute> = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") {
      element.addEventListener(name.slice(2), value as unknown as EventListener);
    } else if (value !== false && value !== undefined) {
      element.setAttribute(name, value === true ? "" : String(value));
    }
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

export function set_text(node: Node, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

export function set_attribute(element: Element, name: string, value: string | null): void {
  if (value === null) {
    if (element.hasAttribute(name)) element.removeAttribute(name);
  } else if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

export function set_hidden(element: HTMLElement, hidden: boolean): void {
  if (element.hidden !== hidden) element.hidden = hidden;
}

export function set_class(element: Element, name: string, on: boolean): void {
  if (element.classList.contains(name) !== on) element.classList.toggle(name, on);
}

/** Makes the children of `parent` exactly `wanted`, moving only what stands elsewhere. */
export function set_children(parent: Element, wanted: readonly Element[]): void {
  wanted.forEach((child, index) => {
    const present = parent.children[index];
    if (present !== child) parent.insertBefore(child, present ?? null);
  });
  while (parent.children.length > wanted.length) parent.lastElementChild?.remove();
}

/** A definition list of name and value whose rows are kept between updates. */
export class Facts {
  readonly element = h("dl", { class: "facts" });
  private rows_ = new Map<string, { row: HTMLElement; value: HTMLElement }>();

  /** `wide` names rows that need the whole width where the list has two columns. */
  update(facts: readonly (readonly [name: string, value: string])[], wide: readonly string[] = []): void {
    const rows = facts.map(([name, value]) => {
      let entry = this.rows_.get(name);
      if (!entry) {
        const cell = h("dd");
        entry = { row: h("div", { class: wide.includes(name) ? "wide" : "" }, h("dt", {}, name), cell), value: cell };
        this.rows_.set(name, entry);
      }
      set_text(entry.value, value);
      return entry.row;
    });
    set_children(this.element, rows);
  }
}
