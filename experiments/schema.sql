-- The store of one run: one SQLite file (WAL), written by `graze sweep`, read by the report.
-- Doubles that must survive exactly (rays, hits) are hex-float text ("0x1.8p+1"); measures are REAL.
-- An infinite error is stored as 9e999 (SQLite's infinity); NULL means: does not apply.

CREATE TABLE IF NOT EXISTS meta(
  key TEXT PRIMARY KEY,          -- 'format' (1), 'name', 'title', 'config' (its text), 'config_path', 'seed',
  value TEXT NOT NULL);          -- 'match_radius', 'keep_all', 'command', 'finished' (UTC, when complete)

CREATE TABLE IF NOT EXISTS build(
  id INTEGER PRIMARY KEY,
  key TEXT NOT NULL UNIQUE,      -- hash of the fields below up to flags: what decides the numbers
  version TEXT NOT NULL, git_commit TEXT NOT NULL, compiler TEXT NOT NULL, flags TEXT NOT NULL,
  instruction_set TEXT NOT NULL, cpu TEXT NOT NULL, cores INTEGER NOT NULL, system TEXT NOT NULL,
  started TEXT NOT NULL);        -- UTC

CREATE TABLE IF NOT EXISTS surface(
  id INTEGER PRIMARY KEY,
  label TEXT NOT NULL UNIQUE,    -- as on the command line: "teardrop:s=1"
  type TEXT NOT NULL,
  size REAL NOT NULL);           -- L, the surface's length scale

CREATE TABLE IF NOT EXISTS family(
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,     -- "graze"
  summary TEXT NOT NULL,         -- one sentence
  difficulty TEXT NOT NULL);     -- what ray.difficulty is: "offset from tangency / L"

CREATE TABLE IF NOT EXISTS cell(
  id INTEGER PRIMARY KEY,
  surface INTEGER NOT NULL REFERENCES surface(id),
  formulation TEXT NOT NULL, form TEXT NOT NULL,
  solver TEXT NOT NULL,          -- registry name
  options TEXT NOT NULL,         -- "tries=30", empty for the defaults
  precision TEXT NOT NULL,       -- "double"
  certified INTEGER NOT NULL,    -- 1: the solver claims proved answers when its status is ok
  UNIQUE(surface, formulation, solver, options, precision));

CREATE TABLE IF NOT EXISTS skipped(  -- cells and cases left out, with the reason
  what TEXT PRIMARY KEY, reason TEXT NOT NULL);

CREATE TABLE IF NOT EXISTS ray(
  id INTEGER PRIMARY KEY,
  surface INTEGER NOT NULL REFERENCES surface(id),
  family INTEGER NOT NULL REFERENCES family(id),
  idx INTEGER NOT NULL,          -- family, seed and index name a ray for ever
  difficulty REAL,               -- larger = see family.difficulty; NULL where the family has no knob
  scale REAL NOT NULL,           -- the surface's lengths are multiplied by this for this ray (family `scale`), else 1
  ox TEXT NOT NULL, oy TEXT NOT NULL, oz TEXT NOT NULL, dx TEXT NOT NULL, dy TEXT NOT NULL, dz TEXT NOT NULL,
  status TEXT NOT NULL,          -- truth's: ok | coincident
  hits INTEGER NOT NULL,         -- truth's count of distinct hits
  truth TEXT NOT NULL,           -- JSON [{"l":"40 digits","multiplicity":1,"cosine":0.5}, ...]
  condition REAL,                -- largest (|l*| + L/(|n.d|))/|l*| of its hits: relative condition; NULL: no hit
  ambiguous INTEGER,             -- 1: truth's verdict changes under a one-ulp change of an input; NULL: not asked
  UNIQUE(surface, family, idx));

CREATE TABLE IF NOT EXISTS record(   -- one (ray, cell)
  build INTEGER NOT NULL REFERENCES build(id),
  cell INTEGER NOT NULL REFERENCES cell(id),
  ray INTEGER NOT NULL REFERENCES ray(id),
  verdict TEXT NOT NULL,         -- right | wrong | uncertain | failed
  status TEXT NOT NULL,          -- the solver's: ok | uncertain | failed | coincident | invalid
  hits TEXT NOT NULL,            -- l of the reported hits, hex floats, space separated
  missed INTEGER NOT NULL, spurious INTEGER NOT NULL, wrong_first INTEGER NOT NULL,
  ulps REAL,                     -- worst |l - l*| in ulps of l*; infinite if a hit is missed; NULL: no hit to find
  condition_units REAL,          -- worst |l - l*| / (eps (|l*| + L/|n.d|)); infinite if missed
  backward REAL,                 -- worst distance of a claimed point from the surface, ulps of the inputs
  normal_error REAL,             -- worst angle to the true normal, radians
  evaluations INTEGER NOT NULL, iterations INTEGER NOT NULL, starts INTEGER NOT NULL,
  kept TEXT NOT NULL,            -- why it is here: all | wrong | worst | sample
  PRIMARY KEY(build, cell, ray)) WITHOUT ROWID;

CREATE TABLE IF NOT EXISTS tally(    -- counts over all rays of a block, whether their records were kept or not
  build INTEGER NOT NULL, cell INTEGER NOT NULL, family INTEGER NOT NULL, block INTEGER NOT NULL,
  rays INTEGER NOT NULL, right INTEGER NOT NULL, wrong INTEGER NOT NULL,
  uncertain INTEGER NOT NULL, failed INTEGER NOT NULL,
  missed INTEGER NOT NULL, spurious INTEGER NOT NULL, wrong_first INTEGER NOT NULL,  -- rays, not hits
  ambiguous_wrong INTEGER NOT NULL,  -- wrong rays whose true verdict is ambiguous (excusable)
  evaluations INTEGER NOT NULL, iterations INTEGER NOT NULL, starts INTEGER NOT NULL,
  PRIMARY KEY(build, cell, family, block)) WITHOUT ROWID;  -- its presence marks the block as done

CREATE TABLE IF NOT EXISTS histogram(  -- over all rays: exact, mergeable
  build INTEGER NOT NULL, cell INTEGER NOT NULL, family INTEGER NOT NULL,
  metric TEXT NOT NULL,          -- ulps | condition_units | backward | normal_error
  bin INTEGER NOT NULL,          -- floor(4 log2(value)); -100000: exactly 0; 100000: infinite
  count INTEGER NOT NULL,
  PRIMARY KEY(build, cell, family, metric, bin)) WITHOUT ROWID;

CREATE TABLE IF NOT EXISTS timing(   -- second pass: one pinned core, seeded interleaved order, every repeat kept
  build INTEGER NOT NULL, cell INTEGER NOT NULL, family INTEGER NOT NULL,
  repeat INTEGER NOT NULL,
  turn INTEGER NOT NULL,         -- position in the interleaved order
  rays INTEGER NOT NULL, ns_per_ray REAL NOT NULL,
  query TEXT NOT NULL,           -- all | first
  censored INTEGER NOT NULL,     -- 1: the time budget ended before all rays were done
  PRIMARY KEY(build, cell, family, repeat)) WITHOUT ROWID;

CREATE TABLE IF NOT EXISTS note(     -- warnings of a pass: noise, a core that could not be pinned, ...
  id INTEGER PRIMARY KEY, build INTEGER NOT NULL, pass TEXT NOT NULL, text TEXT NOT NULL);
