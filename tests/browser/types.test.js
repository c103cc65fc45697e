// The page's modules keep to the types in their comments.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const HERE = dirname(fileURLToPath(import.meta.url));

test("tsc --checkJs has nothing to say about web/", () => {
  const { status, stdout } = spawnSync(join(HERE, "node_modules/.bin/tsc"), ["-p", HERE], { encoding: "utf8" });
  assert.equal(status, 0, stdout);
});
