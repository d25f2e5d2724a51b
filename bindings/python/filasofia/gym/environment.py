"""What all environments share: instruments that an action moves, resets, observations, rewards."""

from __future__ import annotations

import copy
import typing

import gymnasium
import numpy as np

import filasofia as fs

from . import bodies
from .checks import check_bodies, check_features, check_judgement, check_tools, missing, whole
from .judgement import Judgement
from .state import EnvState, restore, saved
from .tool import Array, Tool, aim, posed


DRAPE = fs.TissueMaterial(
    base_color=(0.015, 0.13, 0.14), wetness=0, vessels=0, mottling=0.1, bump=0.2, subsurface_color=(0.01, 0.1, 0.1)
)
STEEL = fs.MetalMaterial(base_color=(0.85, 0.87, 0.9), roughness=0.55)
FAR = 0.3  #: [m]


def distance(a: Array, b: Array) -> float:
    """Between two places [m]; at most FAR, so that what has left the field costs a bounded reward."""
    return min(float(np.linalg.norm(np.asarray(a) - np.asarray(b))), FAR)


class SurgicalEnv(gymnasium.Env):
    """Base class of the environments: derive from it for one of your own (docs/guide/environments.md).

    A task overrides build(), which adds bodies and returns its tools, and prepare(), arrange(), features() and judge().

    Observations, float32: "state" is features() and, for each tool, its place, its joints and whether it holds
    something, all about in [-1, 1]; "rgb" is a picture (height, width, 3), uint8; "rgbd" is a dict of it
    as "rgb" and of "depth": (height, width), [m] along the viewing direction, at most the `far` of the lens.

    Actions: "box" is in [-1, 1], and clipped to it: for each tool its velocity along x, y, z, that of each of its
    joints, and for tools that grip one more component: above 0.3 it closes, below -0.3 it opens. "discrete" is one of:
    nothing; for each tool a move along -x, +x, -y, +y, -z or +z, of each joint back or on, and, if it grips, close and
    open.

    Each episode starts from the same saved state, also after cuts; only what arrange() draws from `np_random` differs.
    The same seed and the same actions give the same bits.

    Pictures show all bodies, unless the task calls self.sim.show(): then those, and what the functions below add.
    """

    metadata: dict[str, typing.Any] = {"render_modes": ["rgb_array"], "render_fps": 50}
    rate = 500  #: [Hz], steps of physics
    least_rate = 50  #: [Hz], below which the task is not what it should be
    levels = 3  #: difficulties
    longest = 300  #: actions of an episode, unless max_steps says how many
    scene: str | None = None  #: a scene file of the assets, whose bodies self.sim has before build()
    eye, looks_at = (0.0, 0.1, 0.16), (0.0, 0.015, 0.0)  #: [m], of the camera
    lit: fs.Box | None = None  #: [m], what the light is made for: all that is shown, if there is no box
    lens = fs.CameraDef(vertical_field_of_view=0.7, near=0.001, exposure=10.2)
    _spec: typing.Any = None

    def __init__(
        self,
        *,
        observation: str = "state",
        action: str = "box",
        difficulty: int = 0,
        image_size: tuple[int, int] = (128, 128),
        quality: typing.Literal["low", "medium", "high"] = "high",
        max_steps: int | None = None,
        frame_skip: int | None = None,
        threads: int = 1,
        render_mode: str | None = None,
    ):
        self._check("observation", observation, ("state", "rgb", "rgbd"))
        self._check("action", action, ("box", "discrete"))
        self._check("quality", quality, ("low", "medium", "high"))
        self._check("render_mode", render_mode, (None, "rgb_array"))
        self.observation, self.action, self.render_mode = observation, action, render_mode
        self.difficulty = self._bound("difficulty", difficulty, 0, self.levels - 1)
        self.max_steps = self._bound("max_steps", self.longest if max_steps is None else max_steps, 1, 10**9)
        self.rate = self._bound("rate", self.rate, self.least_rate, 100_000)
        frame_skip = self.rate // 50 if frame_skip is None else frame_skip  # actions of 20 ms
        self.frame_skip = self._bound("frame_skip", frame_skip, 1, 1000)
        self.image_size = self._size(image_size)
        physics, look = fs.PhysicsDef(rate=self.rate, threads=threads), fs.LookDef(quality=quality, around=self.lit)
        file = None if self.scene is None else fs.asset(self.scene)
        self.sim = fs.Simulation(physics, look=look) if file is None else fs.load(file, physics=physics, look=look)
        self.cuts: list[fs.CutEvent] = []  #: what was cut in this episode
        self.tools = check_tools(type(self).__name__, self.build(), self.sim.bodies)
        self._sizes = [tool.size for tool in self.tools]
        self.sim.on(fs.CutEvent, self.cuts.append)
        self._began = self._closed = False
        self._random: dict[str, typing.Any] = {}  # of np_random, where the episode began
        self._actions: list[Array] = []  # since then
        self.sim.step()
        self.prepare()
        self._start, self._bodies = self.sim.save_state(), self.sim.bodies
        self.steps = 0
        self._arrange()
        if action == "box":
            self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (sum(self._sizes),), np.float32)
        else:
            self.action_space = gymnasium.spaces.Discrete(1 + 2 * sum(self._sizes))
        if observation == "state":
            self.observation_space = gymnasium.spaces.Box(-10.0, 10.0, self._state().shape, np.float32)
        else:
            width, height = self.image_size
            picture = gymnasium.spaces.Box(0, 255, (height, width, 3), np.uint8)
            depth = gymnasium.spaces.Box(0.0, self.lens.far, (height, width), np.float32)
            both = gymnasium.spaces.Dict({"rgb": picture, "depth": depth})
            self.observation_space = both if observation == "rgbd" else picture

    # What a task overrides.

    def build(self) -> list[Tool]:
        """Adds bodies to self.sim; returns the instruments."""
        raise missing(self, "build(), which adds bodies and returns the tools")

    def prepare(self) -> None:
        """What is done once, after the first step: look up nodes, attach, let tissue settle."""

    def arrange(self) -> None:
        """Begins an episode: draws from self.np_random, places targets with self.put()."""

    def features(self) -> Array:
        """What the state observation has besides the tools: any shape; positions with self.unit()."""
        return np.zeros(0)

    def judge(self) -> Judgement:
        """Judges the present state."""
        raise missing(self, "judge(), which returns a Judgement")

    def view(self) -> fs.Pose:
        """Where the camera is."""
        return fs.look_at(self.eye, self.looks_at)

    def limit(self, tool: Tool, place: Array) -> Array:
        """Where a tool comes that is moved to a place of its workspace, if something is in its way."""
        return place

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        """What moves with the tools: where each body is at the end of the present action."""
        return {tool.body: tool.pose() for tool in self.tools}

    def catch(self, tool: Tool) -> fs.AttachmentId | None:
        """Closes a tool: it grasps what it touches, or nothing. A clamp may hold what is near."""
        if tool.grips is None or not self._touches(tool):
            return None
        return self.sim.grasp(tool.body, tool.grips)

    # What tasks use.

    def block(self, name: str, size: typing.Any, cells: typing.Any, **fields: typing.Any) -> fs.BodyId:
        """Adds a block of tissue that collides, with a picture (`look`), pinned at its lower face.

        `fields` are those of SoftBodyDef; attachments replace the pins.
        """
        if "attachments" not in fields:
            y = fields.get("pose", (0, 0, 0))[1] - size[1] / 2
            fields["attachments"] = [fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, y + 1e-4, 1)))]
        return self.soft(name, fs.shapes.block(size, cells), **fields)

    def soft(self, name: str, mesh: fs.TetMesh, **fields: typing.Any) -> fs.BodyId:
        """Adds tissue that collides, with a picture (`look`); `fields` are those of SoftBodyDef."""
        look = fields.pop("look", fs.TissueMaterial())
        fields.setdefault("material", fs.FemMaterial(young_modulus=5e3, poisson_ratio=0.45))
        fields.setdefault("collision", [fs.CollisionDef()])
        body = self.sim.add(fs.SoftBodyDef(name=name, mesh=mesh, **fields))
        self._draw(body, material=look)
        return body

    def table(self, size: typing.Any = (0.6, 0.01, 0.6), top: float = 0.0) -> fs.BodyId:
        """Adds a table, which catches what falls; `top` is its height [m]."""
        body = self.sim.add(
            fs.RigidBodyDef(
                name="table",
                elements=[(0, top - size[1] / 2, 0)],
                mesh=fs.shapes.box(size),
                collision=[fs.CollisionDef()],
                friction=0.4,
            )
        )
        self._draw(body, material=DRAPE)
        return body

    def tip(self, name: str, start: typing.Any, radius: float = 0.004) -> fs.BodyId:
        """Adds the tip of an instrument: a steel ball, moved by actions; its shaft is only drawn."""
        body = self.sim.add(
            fs.RigidBodyDef(
                name=name, elements=[start], mesh=fs.shapes.sphere(radius), collision=[fs.CollisionDef()], friction=0.5
            )
        )
        rod = fs.shapes.cylinder(0.6 * radius, 0.06)
        shaft = fs.TriangleMesh(vertices=np.asarray(rod.vertices) + (0, 0.03, 0), triangles=rod.triangles)
        for surface in (fs.shapes.sphere(radius), shaft):
            self._draw(body, surface=surface, material=fs.MetalMaterial(), cast_shadows=False)
        return body

    def grasper(self, name: str, start: typing.Any, port: typing.Any) -> fs.BodyId:
        """Adds an instrument with two jaws, whose middle is its tip; it collides with nothing."""
        pose = posed(start, aim(start, port))
        body = self.sim.add(fs.RigidBodyDef(name=name, elements=[pose], mesh=fs.shapes.sphere(0.002)))
        shaft = bodies.moved(fs.shapes.cylinder(0.002, 0.16), (0, 0.09, 0))
        jaw = fs.shapes.box((0.0008, 0.012, 0.002))
        jaws = bodies.joined(*(bodies.moved(jaw, (x, 0.0045, 0)) for x in (-0.001, 0.001)))
        for surface in (shaft, jaws):
            self._draw(body, surface=surface, material=STEEL, cast_shadows=False)
        return body

    def blade(
        self, name: str, start: typing.Any, corners: typing.Any, drawn: typing.Any, look: typing.Any
    ) -> fs.BodyId:
        """Adds a rectangle [m] whose edges cut, drawn as a surface or as a box of the size `drawn` [m]."""
        surface = fs.TriangleMesh(vertices=corners, triangles=[[0, 1, 2], [0, 2, 3]])
        cutting = [fs.CollisionDef(mesh=surface, cutting=True)]
        body = self.sim.add(fs.RigidBodyDef(name=name, elements=[start], mesh=surface, collision=cutting))
        self._draw(body, surface=drawn if isinstance(drawn, fs.TriangleMesh) else fs.shapes.box(drawn), material=look)
        return body

    def marker(self, name: str, color: typing.Any, radius: float = 0.003) -> fs.BodyId:
        """Adds a ball that touches nothing and glows, to show a place."""
        body = self.sim.add(fs.RigidBodyDef(name=name, elements=[(0, 0, 0)], mesh=fs.shapes.sphere(radius)))
        self._draw(body, material=fs.UnlitMaterial(color=color), cast_shadows=False)
        return body

    def put(self, marker: fs.BodyId, place: Array) -> None:
        """Moves a marker."""
        self.sim.set_pose(marker, tuple(float(each) for each in place))

    def shift(self, tool: Tool, low: typing.Any, high: typing.Any) -> None:
        """Lets a tool begin the episode beside its start: by an offset [m] that is drawn between two corners."""
        tool.place = np.array(tool.start) + self.np_random.uniform(low, high)
        self.put(tool.body, tool.place)

    def unit(self, place: Array) -> Array:
        """Places [m] as numbers that are in [-1, 1] in the box around the workspaces of all tools."""
        low = np.min([tool.low for tool in self.tools], axis=0)
        high = np.max([tool.high for tool in self.tools], axis=0)
        return (2.0 * np.asarray(place) - low - high) / (high - low)

    def carry(self, tools: list[Tool], low: typing.Any, high: typing.Any, steps: int = 40) -> None:
        """Lets tools, and what hangs at them, begin beside their start: the same offset [m], drawn between two corners.

        They are moved there by physics, in so many steps.
        """
        away = self.np_random.uniform(low, high)
        for tool in tools:
            tool.place = np.array(tool.start) + away
        self.sim.step(steps, self.moves())

    def node(self, body: fs.BodyId, place: typing.Any) -> int:
        """The node of a body that is nearest to a place [m] now; after the first step."""
        away = np.linalg.norm(self.sim.frame[body].positions - np.array(place), axis=1)
        return int(away.argmin())

    def force(self, tool: Tool) -> Array:
        """What contacts, and what it holds, do to a tool in the last step [N]."""
        frame = self.sim.frame
        held = frame.attachments
        return (
            np.array(frame.contact_force(tool.body))
            + held["force"][held["body"] == tool.body].sum(axis=0)
            - held["force"][held["to"] == tool.body].sum(axis=0)
        )

    def holds(self, tool: Tool) -> bool:
        """Whether it has grasped something, and still holds it."""
        if tool.grasp is None:
            return False
        held = self.sim.frame.attachments
        return bool(np.any((held["id"] == tool.grasp) & ~held["broken"]))

    # gymnasium.Env

    @property
    def spec(self) -> typing.Any:
        """What gymnasium.make() made it from, with max_steps as its max_episode_steps; None if it did not make it."""
        return self._spec

    @spec.setter
    def spec(self, made_from: typing.Any) -> None:
        # The environment ends its episodes itself: were the number registered, make() would add a TimeLimit of it,
        # which a larger max_steps could not lift.
        self._spec = copy.copy(made_from)
        if self._spec is not None:
            self._spec.max_episode_steps = self.max_steps

    def reset(
        self, *, seed: int | None = None, options: dict[str, typing.Any] | None = None
    ) -> tuple[Array, dict[str, typing.Any]]:
        """`options` must be empty: what an episode depends on is given to the constructor."""
        name = type(self).__name__
        if not isinstance(options, (dict, type(None))):
            raise fs.Error(f"{name}: reset: options must be a dict, got {options!r}")
        for each in options or {}:
            raise fs.Error(f"{name}: reset: unknown option {each!r}; options are arguments of the constructor")
        self._check_open("reset")
        super().reset(seed=seed)
        judgement = self._begin()
        return self._observe(), self._info(judgement)

    def step(self, action: typing.Any) -> tuple[Array, float, bool, bool, dict[str, typing.Any]]:
        self._check_ready()
        broken, judgement = self._advance(action)
        reward = float(sum(judgement.reward.values()))
        return self._observe(), reward, judgement.success or broken, self.steps >= self.max_steps, self._info(judgement)

    def save_state(self) -> EnvState:
        """The present state: simulation, instruments, random numbers, and what the task's attributes hold.

        It can be pickled, so that other processes continue from it, with the same bits. Attributes that cannot be
        pickled are no part of it.
        """
        return saved(self)

    def restore_state(self, state: EnvState) -> None:
        """Returns to a state of this environment, or of another one of this class with the same options.

        A state that was pickled is reached by making the steps that led to it, the first time. Error if these lead
        somewhere else, because something besides the actions has changed the episode.
        """
        restore(self, state)

    def _hash(self) -> str:
        return f"{self.sim.state_hash:016x}"

    def _begin(self) -> Judgement:
        """Begins an episode with the random numbers that are next."""
        self._began, self._actions = True, []
        self._random = copy.deepcopy(dict(self.np_random.bit_generator.state))
        self._check_bodies("an episode")
        self.sim.restore(self._start)
        self.cuts.clear()
        self.steps = 0
        for tool in self.tools:
            tool.reset()
        self._arrange()
        self.sim.step()
        return self._judged()

    def _arrange(self) -> None:
        self.arrange()
        self._check_bodies("arrange()")

    def _check_bodies(self, who: str) -> None:
        """Error if there are other bodies than those of the state that each episode returns to."""
        check_bodies(type(self).__name__, who, self.sim, self._bodies)

    def _advance(self, action: typing.Any) -> tuple[bool, Judgement]:
        """One action; whether the simulation broke, and how the state is judged."""
        moves = self._moves(action)
        self._actions.append(np.array(action))
        parts = self._parts()
        steps, broke = self.frame_skip // parts, False
        for part in range(parts):
            for tool, move in zip(self.tools, moves):
                tool.place = self._against(tool, self.limit(tool, tool.move(move, steps / self.rate)))
                if tool.grips is not None and part == 0:
                    self._grip(tool, move[-1])
            broke |= fs.StepFlag.UNDONE in self.sim.step(steps, self.moves()).flags
        self.steps += 1
        return broke, self._judged()

    def _parts(self) -> int:
        """How often hands look at their forces during an action: in each step, if one has a finite strength.

        Once per action a hand of PegTransfer moved by 4 mm in between, and caught a ring with 49 N.
        """
        return self.frame_skip if any(np.isfinite(tool.strength) for tool in self.tools) else 1

    def render(self) -> Array | None:
        """A picture of image_size, (height, width, 3), uint8; None without a render_mode."""
        self._check_open("render")
        return self._picture() if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        self._closed = True
        self.sim.close()

    # The rest.

    def _draw(self, body: fs.BodyId, **fields: typing.Any) -> None:
        """Shows a body; unlike self.sim.show() this leaves it at showing all others, too."""
        self.sim._show(body, fs.ShowDef(**fields), True)  # type: ignore[attr-defined]

    def _against(self, tool: Tool, place: Array) -> Array:
        """Where a hand of finite strength comes: it does not move on against a larger force."""
        if np.isinf(tool.strength):
            return place
        force = self.force(tool)
        against = force @ (place - tool.place) < 0.0
        return tool.place if against and np.linalg.norm(force) > tool.strength else place

    def _grip(self, tool: Tool, command: float) -> None:
        if command < -0.3 and tool.grasp is not None:
            self.sim.release(tool.grasp)
            tool.grasp = None
        elif command > 0.3 and not self.holds(tool):
            tool.grasp = self.catch(tool)

    def _touches(self, tool: Tool) -> bool:
        contacts = self.sim.frame.contacts
        one, other = contacts["first"], contacts["second"]
        pair = ((one == tool.body) & (other == tool.grips)) | ((one == tool.grips) & (other == tool.body))
        return bool(np.any(pair & (contacts["normal_force"] > 0)))

    def _moves(self, action: typing.Any) -> list[Array]:
        name, count = type(self).__name__, sum(self._sizes)
        try:
            given = np.asarray(action)
            real = given.dtype.kind in "biufO" and not np.ma.isMaskedArray(action)
            given = given.astype(float) if real else np.array(np.nan)
        except (TypeError, ValueError):
            given = np.array(np.nan)
        if self.action == "box":
            if given.shape != (count,) or not np.isfinite(given).all():
                raise fs.Error(f"{name}: the action must be {count} finite numbers, got {action!r}")
            values = np.clip(given, -1.0, 1.0)
        else:
            if given.size != 1 or given.item() not in range(1 + 2 * count):
                raise fs.Error(f"{name}: the action must be a whole number in [0, {2 * count}], got {action!r}")
            values, choice = np.zeros(count), int(given.item())
            if choice > 0:
                values[(choice - 1) // 2] = -1.0 if choice % 2 else 1.0
        return list(np.split(values, np.cumsum(self._sizes)[:-1]))

    def _judged(self) -> Judgement:
        return check_judgement(type(self).__name__, self.judge())

    def _state(self) -> Array:
        parts: list[Array] = [check_features(type(self).__name__, self.features())]
        for tool in self.tools:
            parts += [self.unit(tool.place), tool.units()]
            if tool.grips is not None:
                parts.append([1.0 if self.holds(tool) else -1.0])
        return np.clip(np.concatenate(parts), -10.0, 10.0).astype(np.float32)

    def _observe(self) -> Array:
        if self.observation == "state":
            state = self._state()
            if state.shape != self.observation_space.shape:
                more = state.size - int(np.prod(self.observation_space.shape or ()))
                words = f"got {abs(more)} {'more' if more > 0 else 'fewer'}"
                raise fs.Error(f"{type(self).__name__}: features() must return as many numbers as at first, {words}")
            return state
        if self.observation == "rgb":
            return self._picture()
        depth = self.sim.render_depth(*self.image_size, pose=self.view(), camera=self.lens).depth
        return {"rgb": self._picture(), "depth": np.minimum(depth, np.float32(self.lens.far))}

    def _picture(self) -> Array:
        return np.asarray(self.sim.render(*self.image_size, pose=self.view(), camera=self.lens))

    def _info(self, judgement: Judgement) -> dict[str, typing.Any]:
        return {
            "is_success": bool(judgement.success),
            "reward_terms": judgement.reward,
            "measures": judgement.measures,
            "state_hash": self._hash(),
        }

    def _check_open(self, what: str) -> None:
        if self._closed:
            raise fs.Error(f"{type(self).__name__}: {what}: the environment is closed; make another one")

    def _check_ready(self) -> None:
        self._check_open("step")
        if not self._began:
            raise fs.Error(f"{type(self).__name__}: step: no episode has begun: call reset() before")

    def _check(self, name: str, value: typing.Any, known: tuple[typing.Any, ...]) -> None:
        if value not in known:
            raise fs.Error(f"{type(self).__name__}: {name} must be one of {', '.join(map(repr, known))}, got {value!r}")

    def _bound(self, name: str, value: typing.Any, low: int, high: int) -> int:
        number = whole(value, low, high)
        if number is None:
            raise fs.Error(f"{type(self).__name__}: {name} must be a whole number in [{low}, {high}], got {value!r}")
        return number

    def _size(self, given: typing.Any) -> tuple[int, int]:
        sides = [whole(each, 1, 8192) for each in given] if isinstance(given, (tuple, list, np.ndarray)) else []
        if len(sides) != 2 or sides[0] is None or sides[1] is None:
            name = type(self).__name__
            raise fs.Error(f"{name}: image_size must be two whole numbers in [1, 8192], got {given!r}")
        return sides[0], sides[1]
