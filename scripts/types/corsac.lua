---@meta
-- Types for the Lua language server, written by `make docs`.

---@class corsac.AxisAngle
---@field axis number[]
---@field angle number radians

---@class corsac.Columns
---@field n integer
---@field row fun(body: corsac.Body): integer
---@field handle fun(row: integer): corsac.Body
---@field touch fun(row: integer)
---@field [string] number[]

---A thing in the scene.
---@class corsac.Entity
local Entity = {}

---Where it is in the world.
---@return number x
---@return number y
---@return number z
function Entity:getPosition() end

---Teleports it, its body and its children.
---@param x number
---@param y number
---@param z number
function Entity:setPosition(x, y, z) end

---Its rotation in the world as a quaternion.
---@return number x
---@return number y
---@return number z
---@return number w
function Entity:getRotation() end

---Turns it; the quaternion is normalised.
---@param x number
---@param y number
---@param z number
---@param w number
function Entity:setRotation(x, y, z, w) end

---Scales its mesh and its children, never its body.
---@param x number
---@param y number
---@param z number
function Entity:setScale(x, y, z) end

---Colour that multiplies its material's.
---@param r number
---@param g number
---@param b number
---@param a? number
function Entity:setColor(r, g, b, a) end

---Its body, or nil.
---@return corsac.Body? body
function Entity:getBody() end

---What moves its model, or nil.
---@return corsac.Animator? animator
function Entity:getAnimator() end

---The name it was given, "" without.
---@return string name
function Entity:getName() end

---The entity it hangs on, or nil.
---@return corsac.Entity? parent
function Entity:getParent() end

---Hangs it on another entity (nil: on none); it stays where it is.
---@param parent? corsac.Entity new parent
function Entity:setParent(parent) end

---Gives it a tag; a new name makes one (at most 64).
---@param name string of the tag
function Entity:addTag(name) end

---Takes a tag from it.
---@param name string of the tag
function Entity:removeTag(name) end

---Whether it has a tag.
---@param name string of the tag
---@return boolean has
function Entity:hasTag(name) end

---Whether it was destroyed; every other method then raises an error.
---@return boolean destroyed
function Entity:isDestroyed() end

---Removes it, its body, its mesh and its children.
function Entity:destroy() end

---A rigid body.
---@class corsac.Body
local Body = {}

---Where its origin is.
---@return number x
---@return number y
---@return number z
function Body:getPosition() end

---Teleports it.
---@param x number
---@param y number
---@param z number
function Body:setPosition(x, y, z) end

---Its rotation as a quaternion.
---@return number x
---@return number y
---@return number z
---@return number w
function Body:getRotation() end

---Turns it; the quaternion is normalised.
---@param x number
---@param y number
---@param z number
---@param w number
function Body:setRotation(x, y, z, w) end

---Velocity of its centre of mass.
---@return number x
---@return number y
---@return number z
function Body:getVelocity() end

---Sets the velocity of its centre of mass.
---@param x number
---@param y number
---@param z number
function Body:setVelocity(x, y, z) end

---Angular velocity in the world's frame.
---@return number x
---@return number y
---@return number z
function Body:getAngularVelocity() end

---Sets the angular velocity.
---@param x number
---@param y number
---@param z number
function Body:setAngularVelocity(x, y, z) end

---Moves it to another collision layer.
---@param name string a new name makes a layer
function Body:setLayer(name) end

---Name of its collision layer.
---@return string name
function Body:getLayer() end

---Pushes at its centre of mass during the next step.
---@param x number
---@param y number
---@param z number
function Body:applyForce(x, y, z) end

---Changes its momentum at once.
---@param x number
---@param y number
---@param z number
---@param px? number where, in the world
---@param py? number
---@param pz? number
function Body:applyImpulse(x, y, z, px, py, pz) end

---Turns it about its centre of mass during the next step.
---@param x number
---@param y number
---@param z number
function Body:applyTorque(x, y, z) end

---How it moves: "dynamic", "static" or "kinematic".
---@return string type
function Body:getType() end

---Geometry of one of its shapes, as in newBody.
---@param number? integer from 1
---@return string shape
function Body:getShape(number) end

---How many shapes it has.
---@return integer count
function Body:getShapeCount() end

---Sets the losses of its velocities.
---@param linear number
---@param angular number
function Body:setDamping(linear, angular) end

---The losses of its velocities.
---@return number linear
---@return number angular
function Body:getDamping() end

---Sets the factor on gravity.
---@param factor number
function Body:setGravityScale(factor) end

---The factor on gravity.
---@return number factor
function Body:getGravityScale() end

---Sets the world axes along and about which it never moves.
---@param axes string any of x y z turnX turnY turnZ, spaces between
function Body:setLocks(axes) end

---The axes along and about which it never moves, as in setLocks.
---@return string axes
function Body:getLocks() end

---Sets the material of all its shapes.
---@param friction number
---@param restitution number
---@param rolling number
function Body:setMaterial(friction, restitution, rolling) end

---The material of its first shape.
---@return number friction
---@return number restitution
---@return number rolling
function Body:getMaterial() end

---Its mass; 0 for static bodies.
---@return number mass
function Body:getMass() end

---The entity it belongs to, or nil.
---@return corsac.Entity? entity
function Body:getEntity() end

---Whether it was destroyed; every other method then raises an error.
---@return boolean destroyed
function Body:isDestroyed() end

---Removes it from the world.
function Body:destroy() end

---A region that reports bodies and pushes nothing.
---@class corsac.Trigger
local Trigger = {}

---Moves it.
---@param x number
---@param y number
---@param z number
function Trigger:setPosition(x, y, z) end

---Removes it; bodies inside get their exit at the next step.
function Trigger:destroy() end

---An acceleration that acts on bodies.
---@class corsac.Field
local Field = {}

---Removes it.
function Field:destroy() end

---What holds two bodies, or a body and the world.
---@class corsac.Joint
local Joint = {}

---What it did to body b at the anchor, mean over the last step.
---@return number x
---@return number y
---@return number z
function Joint:getForce() end

---The same about the anchor.
---@return number x
---@return number y
---@return number z
function Joint:getTorque() end

---Angle in rad (revolute; ball: twist; universal: of axisB about axis), way in m (prismatic) or length in m (distance; pulley: a's side).
---@return number value
function Joint:getValue() end

---Drives all but fixed and ball joints; a pivot's turns b.
---@param speed number of b against a
---@param max number most it gives; 0 turns it off
function Joint:setMotor(speed, max) end

---Range of getValue.
---@param lower number
---@param upper number
function Joint:setLimits(lower, upper) end

---Spring towards a value of getValue.
---@param hertz number 0 turns it off
---@param dampingRatio? number 1 comes to rest soonest
---@param rest? number where it comes to rest
function Joint:setSpring(hertz, dampingRatio, rest) end

---Whether it broke or was destroyed; every other method then raises an error.
---@return boolean destroyed
function Joint:isDestroyed() end

---Removes it; onBreak is not called.
function Joint:destroy() end

---An upright capsule that walks: slopes, steps, platforms, pushing.
---@class corsac.Mover
local Mover = {}

---Sets the velocity it wishes, seen from the ground, until it is changed; y counts without gravity only.
---@param x number
---@param y number
---@param z number
function Mover:walk(x, y, z) end

---Leaves the ground, or jumps again in the air: when that is allowed is your rule.
---@param speed number upwards
function Mover:jump(speed) end

---Changes its size, feet in place; false and unchanged where it would not fit.
---@param radius number
---@param height number in all
---@return boolean fits
function Mover:resize(radius, height) end

---Centre of the capsule.
---@return number x
---@return number y
---@return number z
function Mover:getPosition() end

---How it went in the last step, with the platform it rides on.
---@return number x
---@return number y
---@return number z
function Mover:getVelocity() end

---"ground", "steep" (touches only what is too steep) or "air", the body it stands on (or nil) and the normal of its surface.
---@return string ground
---@return corsac.Body? body
---@return number x
---@return number y
---@return number z
function Mover:getGround() end

---By how much the ground turned about +y in the last step.
---@return number turn
function Mover:getTurn() end

---Puts it elsewhere, at rest.
---@param x number
---@param y number
---@param z number
function Mover:setPosition(x, y, z) end

---Whether it was destroyed; every other method then raises an error.
---@return boolean destroyed
function Mover:isDestroyed() end

---Removes it.
function Mover:destroy() end

---Particles that hold together: a sheet, or a rope with one column.
---@class corsac.Cloth
local Cloth = {}

---Holds a particle where it is, to a body that moves it along and feels its pull.
---@param column integer from 1
---@param row integer from 1
---@param body? corsac.Body without, the world
function Cloth:hold(column, row, body) end

---Holds a particle to a place of the world, to which it goes within the step.
---@param column integer from 1
---@param row integer from 1
---@param x number
---@param y number
---@param z number
function Cloth:pin(column, row, x, y, z) end

---Lets a particle go.
---@param column integer from 1
---@param row integer from 1
function Cloth:release(column, row) end

---Gives a particle an impulse.
---@param column integer from 1
---@param row integer from 1
---@param x number
---@param y number
---@param z number
function Cloth:push(column, row, x, y, z) end

---Where a particle is.
---@param column integer from 1
---@param row integer from 1
---@return number x
---@return number y
---@return number z
function Cloth:getPoint(column, row) end

---Where all are: x, y, z of each, column by column, row after row.
---@return number[] points
function Cloth:getPoints() end

---How many edges are torn.
---@return integer count
function Cloth:getTorn() end

---How far edges are from their length, relative: mean and most.
---@return number mean
---@return number most
function Cloth:getStretch() end

---Whether it lies still and costs nothing.
---@return boolean asleep
function Cloth:isAsleep() end

---Whether it was destroyed; every other method then raises an error.
---@return boolean destroyed
function Cloth:isDestroyed() end

---Removes it.
function Cloth:destroy() end

---A source of light.
---@class corsac.Light
local Light = {}

---Moves a point or spot light.
---@param x number
---@param y number
---@param z number
function Light:setPosition(x, y, z) end

---Turns a spot or directional light: where its light goes.
---@param x number
---@param y number
---@param z number
function Light:setDirection(x, y, z) end

---Changes colour and intensity.
---@param r number linear
---@param g number linear
---@param b number linear
---@param intensity number point, spot: radiant intensity; directional: irradiance
function Light:setColor(r, g, b, intensity) end

---Removes the light.
function Light:destroy() end

---How a surface looks: metallic-roughness, as glTF.
---@class corsac.Material
local Material = {}

---Changes what parameter(i) gives in the material's shader.
---@param parameters number[] up to 16 numbers; the others become 0
function Material:setParameters(parameters) end

---Removes the material: what has it is drawn in the plain one.
function Material:destroy() end

---A part of the picture, or a texture, with a camera.
---@class corsac.View
local View = {}

---@class View.setCamera.options
---@field position? number[] of the eye, m
---@field target? number[] point it looks at, m
---@field rotation? number[]|corsac.AxisAngle in place of target; looks along -Z
---@field fov? number vertical field of view, rad
---@field near? number nearest visible distance, m
---@field far? number no point or spot light is seen beyond, m
---@field height? number of what is seen without perspective; 0: with perspective, m

---Moves the view's camera.
---@param options View.setCamera.options the camera
function View:setCamera(options) end

---Removes the view; who shows its texture shows a checker then.
function View:destroy() end

---A pass over the picture by a shader of the game.
---@class corsac.Effect
local Effect = {}

---Changes what parameter(i) gives in the shader.
---@param parameters number[] up to 16 numbers; the others become 0
function Effect:setParameters(parameters) end

---Takes the pass away.
function Effect:destroy() end

---A source of particles.
---@class corsac.Emitter
local Emitter = {}

---Moves the emitter; births until the next step are spread over the way.
---@param x number
---@param y number
---@param z number
---@param rotation? number[]|corsac.AxisAngle takes +Y to where particles fly
function Emitter:setPosition(x, y, z, rotation) end

---Changes how many are born.
---@param rate number
function Emitter:setRate(rate) end

---Gives birth to many at once.
---@param count integer
function Emitter:burst(count) end

---Goes with an entity from the next step on; without it nothing more is born.
---@param entity corsac.Entity
function Emitter:follow(entity) end

---How many of its particles are alive.
---@return integer count
function Emitter:getCount() end

---Removes the emitter and its particles.
function Emitter:destroy() end

---Ground drawn from a field of heights.
---@class corsac.Terrain
local Terrain = {}

---Height of the surface above a place, nil beside it.
---@param x number
---@param z number
---@return number? y
function Terrain:getHeight(x, z) end

---Removes the terrain.
function Terrain:destroy() end

---Meshes, skeleton and clips read from a file.
---@class corsac.Model
local Model = {}

---Its skeleton, or nil.
---@return corsac.Skeleton? skeleton
function Model:getSkeleton() end

---Its clip of that name.
---@param name string as in the model's file
---@return corsac.Clip clip
function Model:getClip(name) end

---All its clips.
---@return corsac.Clip[] clips
function Model:getClips() end

---Bones with a bind pose.
---@class corsac.Skeleton
local Skeleton = {}

---How many bones it has.
---@return integer count
function Skeleton:getBoneCount() end

---Names of its bones, parents first.
---@return string[] names
function Skeleton:getBones() end

---Removes it; clips and animators that use it must go first.
function Skeleton:destroy() end

---Keys of bones over time.
---@class corsac.Clip
local Clip = {}

---Its name.
---@return string name
function Clip:getName() end

---How long it is.
---@return number duration
function Clip:getDuration() end

---Removes it; what plays it must go first.
function Clip:destroy() end

---States with clips and transitions between them.
---@class corsac.Machine
local Machine = {}

---@class Machine.extend.options.states.blend
---@field clip corsac.Clip
---@field value number of the parameter at which it plays alone

---@class Machine.extend.options.states
---@field name string unique in the machine
---@field within? string a state listed before it, without clip and blend, that holds this one: a machine in a state; the first held is where it is entered
---@field clip? corsac.Clip what it plays
---@field blend? Machine.extend.options.states.blend[] in place of clip: looping clips between which a parameter blends, values ascending
---@field blendParameter? string a parameter of the machine
---@field loop? "loop"|"once"|"pingpong" what happens at the clip's end
---@field speed? number factor on time; negative: backwards
---@field onEnter? function called with the animator
---@field onExit? function called with the animator
---@field onTick? function called each step with the animator and dt
---@field getSpeed? function gives a factor on time; called with the animator and the phase from 0 to 1

---@class Machine.extend.options.transitions
---@field from? string state it leaves, or any within it (nil: any other)
---@field to string state it enters
---@field condition? function called each step with the animator; true starts it
---@field event? string starts when sent
---@field parameter? string starts when it compares so with value
---@field compare? ">"|"<"|">="|"<="|"=="|"~="
---@field value? number
---@field length? number of the cross-fade, s
---@field fade? "linear"|"smooth" shape of the cross-fade
---@field uninterruptible? boolean no other transition starts before its end
---@field sync? boolean the target starts at the same phase

---@class Machine.extend.options
---@field states? Machine.extend.options.states[] as in corsac.anim.newMachine
---@field transitions? Machine.extend.options.transitions[] tried after those it has

---Adds states and transitions, for all animators that use the machine.
---@param options Machine.extend.options what to add
function Machine:extend(options) end

---The machine as Graphviz text.
---@return string text
function Machine:getDot() end

---Removes it; animators that use it must go first.
function Machine:destroy() end

---One animated skeleton.
---@class corsac.Animator
local Animator = {}

---@class Animator.setGoal.options
---@field goal? integer its number; goals are applied in order
---@field kind? "reach"|"look"|"shift"|"move" reach: the bone and two above it are a limb; look: the bone turns; shift: a limb whose tip goes by the target from where the animation has it; move: the bone moves by the target
---@field bone string tip of the limb, or what looks
---@field target? number[] in the model's frame, m
---@field pole? number[] reach: where the middle joint points
---@field axis? number[] look: the bone's own forward
---@field limit? number look: most it turns (0: any), rad
---@field weight? number 0 removes the goal
---@field keepRotation? boolean reach: the tip stays turned as it was

---Bends the finished pose: a limb reaches a point, or a bone looks at one.
---@param options Animator.setGoal.options the goal
function Animator:setGoal(options) end

---@class Animator.setFeet.options
---@field bones table names of up to four ends of limbs; none: the animation has its feet to itself again
---@field root string bone that carries the body: hips
---@field up? number above the entity, in which ground counts, m
---@field down? number and below, m
---@field speed? number at which a foot follows the ground, m/s
---@field layer? string bodies that are ground

---Feet stand on the ground under them, found by rays, as high as the animation has them; the root sinks as far as the lowest needs. Takes a goal for each foot from 1 on, and one for the root.
---@param options Animator.setFeet.options the feet
function Animator:setFeet(options) end

---@class Animator.startRagdoll.options
---@field mass? number in all, shared by volume, kg
---@field least? number shorter bones move with the one above, m
---@field layer? string of the bodies

---Hands its entity to physics: from the next step on each long bone is a body, with the place and speed that the animation gave it, and bodies give the pose.
---@param options? Animator.startRagdoll.options
function Animator:startRagdoll(options) end

---Ends it: the bodies go, and the pose it fell into turns into the animation's.
---@param length? number how long it takes
function Animator:stopRagdoll(length) end

---Its bodies while it is one, parents first.
---@return corsac.Body[] bodies
function Animator:getRagdoll() end

---@class Animator.setLayer.options
---@field layer? integer 1 is the lowest above the base
---@field machine? corsac.Machine
---@field clip? corsac.Clip without machine and clip it is removed
---@field loop? "loop"|"once"|"pingpong" what happens at the clip's end
---@field mask? corsac.Mask bones it moves
---@field weight? number
---@field additive? boolean adds the clip's change since its first pose

---Plays a clip or machine over the base, on all or some bones.
---@param options Animator.setLayer.options the layer
function Animator:setLayer(options) end

---How much of a layer is seen.
---@param layer integer
---@param weight number
function Animator:setLayerWeight(layer, weight) end

---Plays a clip, whatever its machine says, fading from the pose of this moment.
---@param clip corsac.Clip
---@param length? number of the cross-fade
---@param fade? "linear"|"smooth" shape of the cross-fade
---@param loop? "loop"|"once"|"pingpong" what happens at its end
function Animator:play(clip, length, fade, loop) end

---Changes to a state of its machine, as a transition would.
---@param state string name
---@param length? number of the cross-fade
---@param fade? "linear"|"smooth" shape of the cross-fade
function Animator:go(state, length, fade) end

---Sends an event to its machine; transitions of the next step hear it.
---@param event string name
function Animator:send(event) end

---Sets a parameter of its machine.
---@param name string
---@param value number
function Animator:setParameter(name, value) end

---Value of a parameter of its machine.
---@param name string
---@return number value
function Animator:getParameter(name) end

---Factor on its time; 0 stops, negative plays backwards.
---@param speed number
function Animator:setSpeed(speed) end

---Goes to a place in the current clip.
---@param time number
function Animator:setTime(time) end

---Place in the current clip.
---@return number time
function Animator:getTime() end

---Name of the machine's current state, "" without one.
---@return string state
function Animator:getState() end

---Whether a state of its machine is the current one or holds it.
---@param state string of its machine
---@return boolean inside
function Animator:isIn(state) end

---Progress of the cross-fade (1: none runs) and the state it leaves.
---@return number progress
---@return string from
function Animator:getFade() end

---Targets of the transitions from the current state, in order.
---@return string[] states
function Animator:getTransitions() end

---Whether the current clip has come to its end.
---@return boolean finished
function Animator:isFinished() end

---How far the root moved in the last step, in the animator's frame.
---@return number x
---@return number y
---@return number z
function Animator:getRootMotion() end

---Where a bone is, in the model's frame, since the last step.
---@param bone string name
---@return number x
---@return number y
---@return number z
function Animator:getBonePosition(bone) end

---When false its pose is not computed; its machine still runs.
---@param visible boolean
function Animator:setVisible(visible) end

---Level of detail: its pose is computed at every n-th step only.
---@param every integer steps
function Animator:setRate(every) end

---The entity it moves, or nil.
---@return corsac.Entity? entity
function Animator:getEntity() end

---Whether it was destroyed; every other method then raises an error.
---@return boolean destroyed
function Animator:isDestroyed() end

---Removes it; its entity then shows the bind pose.
function Animator:destroy() end

---Which bones a layer moves, and how much.
---@class corsac.Mask
local Mask = {}

---Removes it; layers that use it must go first.
function Mask:destroy() end

---Waypoints and the links between them.
---@class corsac.Graph
local Graph = {}

---Adds a node; its id is the number of nodes made before it.
---@param x number
---@param y number
---@param z number
---@return integer id
function Graph:add(x, y, z) end

---Removes a node and all its links.
---@param node integer which
function Graph:remove(node) end

---Moves a node; its links keep their costs.
---@param node integer which
---@param x number
---@param y number
---@param z number
function Graph:move(node, x, y, z) end

---Links two nodes both ways at the cost of their distance.
---@param a integer a node
---@param b integer another
function Graph:connect(a, b) end

---Removes the links between two nodes.
---@param a integer a node
---@param b integer another
function Graph:disconnect(a, b) end

---Links one way.
---@param a integer from this node
---@param b integer to this
---@param cost number of the way
function Graph:link(a, b, cost) end

---Removes a link one way.
---@param a integer from this node
---@param b integer to this
function Graph:unlink(a, b) end

---Sets what a link costs.
---@param a integer from this node
---@param b integer to this
---@param cost number of the way
function Graph:setCost(a, b, cost) end

---Opens or closes a link, as a door.
---@param a integer from this node
---@param b integer to this
---@param open boolean may be walked
function Graph:setOpen(a, b, open) end

---Id of the node nearest to a point, nil when there is none.
---@param x number
---@param y number
---@param z number
---@param limit? number largest distance; 0: any
---@return integer? id
function Graph:nearest(x, y, z, limit) end

---Where a node is.
---@param node integer which
---@return number x
---@return number y
---@return number z
function Graph:getPosition(node) end

---How many nodes it has.
---@return integer count
function Graph:getCount() end

---Ids of its nodes, ascending.
---@return integer[] ids
function Graph:getNodes() end

---Links of a node in order of creation: tables {to, cost, open}.
---@param node integer which
---@return table[] links
function Graph:getLinks(node) end

---Nodes, positions, links and costs as text, one node a line.
---@return string text
function Graph:getText() end

---@class Graph.findPath.options
---@field heuristic? "euclid"|"octile"|"zero" of A*; zero is Dijkstra's way
---@field weight? number how many times the least cost the path may cost
---@field partial? boolean without a way: go to the node nearest to the goal
---@field limit? integer nodes to expand at most; 0: any number

---Cheapest way: ids of its nodes (nil without one), its cost, and the status.
---@param start integer from this node
---@param goal integer to this
---@param options? Graph.findPath.options how to search
---@return integer[]? ids
---@return number cost
---@return string status
function Graph:findPath(start, goal, options) end

---Draws its links for one frame.
---@param search? boolean also what the last search on it reached
function Graph:draw(search) end

---Removes it; its paths and agents are left without a way.
function Graph:destroy() end

---A way between two points that follows its graph.
---@class corsac.Path
local Path = {}

---Gives it another start and goal and plans it.
---@param start number[] where it begins
---@param goal number[] where it ends
function Path:set(start, goal) end

---Plans it now; a step does so when the graph has changed.
---@return string status
function Path:update() end

---"found", "partial", "no path" or "invalid" (its graph is gone).
---@return string status
function Path:getStatus() end

---Sum of its links' costs.
---@return number cost
function Path:getCost() end

---Ids of its nodes from start to goal.
---@return integer[] ids
function Path:getNodes() end

---Points of the way from start to goal: tables {x, y, z}.
---@return number[][] points
function Path:getPoints() end

---Removes it.
function Path:destroy() end

---Walks along paths.
---@class corsac.Agent
local Agent = {}

---Walks on a graph to the node nearest to a point, then to the point.
---@param graph corsac.Graph on which
---@param x number
---@param y number
---@param z number
function Agent:go(graph, x, y, z) end

---Walks across a surface to the point of it nearest to a point.
---@param surface corsac.Surface on which
---@param x number
---@param y number
---@param z number
function Agent:cross(surface, x, y, z) end

---Walks with a flow to its goal.
---@param flow corsac.Flow where to
function Agent:follow(flow) end

---Stands still.
function Agent:stop() end

---"idle", "walking", "arrived" or "stuck".
---@return string state
function Agent:getState() end

---Where it stands.
---@return number x
---@return number y
---@return number z
function Agent:getPosition() end

---Places it; not for agents of entities.
---@param x number
---@param y number
---@param z number
function Agent:setPosition(x, y, z) end

---How it moves.
---@return number x
---@return number y
---@return number z
function Agent:getVelocity() end

---Where it looks: about +Y, 0 along -Z.
---@return number heading
function Agent:getHeading() end

---How fast it may go.
---@param speed number
function Agent:setMaxSpeed(speed) end

---Id of the surface's link on which it is now, nothing on the ground.
---@return integer? link
function Agent:getLink() end

---Whom it leads, or nil.
---@return corsac.Entity? entity
function Agent:getEntity() end

---Removes it; its entity stays.
function Agent:destroy() end

---Ground on which an agent can walk.
---@class corsac.Surface
local Surface = {}

---The point of it nearest to a point sideways, nothing when there is none.
---@param x number
---@param y number chooses the storey
---@param z number
---@param limit? number largest distance; 0: any
---@return number? x
---@return number? y
---@return number? z
function Surface:nearest(x, y, z, limit) end

---@class Surface.findPath.options
---@field costs? number[] of a metre in area 0, 1, 2 ...; 0: 1; below 0: not walked
---@field partial? boolean without a way: to the reachable point nearest to the goal

---Shortest way: points {x, y, z, link = id of the link to the next} (nil without one), its cost, and the status.
---@param start number[] where it begins
---@param goal number[] where it ends
---@param options? Surface.findPath.options how to search
---@return number[][]? points
---@return number length
---@return string status
function Surface:findPath(start, goal, options) end

---@class Surface.put.ground.boxes
---@field position? number[] its middle, m
---@field size number|number[] lengths of its edges, m
---@field area? integer 0 to 31, or 255 where nobody walks

---@class Surface.put.ground
---@field vertices? number[] x y z after x y z, m
---@field triangles? number[] three vertices each, counted from 1, counter-clockwise seen from above
---@field areas? number[] of each triangle: 0 to 31, or 255 where nobody walks
---@field boxes? Surface.put.ground.boxes[] upright boxes

---Puts triangles and boxes in the place of those under a key.
---@param key integer a number of its own; 0 is what it was made from
---@param ground Surface.put.ground
function Surface:put(key, ground) end

---Removes what is under a key.
---@param key integer a number of its own; 0 is what it was made from
function Surface:remove(key) end

---@class Surface.mark.box
---@field position? number[] its middle, m
---@field size number|number[] lengths of its edges, m
---@field area? integer 0 to 31, or 255 where nobody walks

---Gives the ground inside a box an area.
---@param key integer a number of its own; 0 is what it was made from
---@param box Surface.mark.box
function Surface:mark(key, box) end

---Makes all tiles anew that wait for it; steps do so a few at a time.
function Surface:update() end

---How many tiles wait to be made anew.
---@return integer tiles
function Surface:getWaiting() end

---@class Surface.addLink.options
---@field from number[] on the surface, m
---@field to number[] on the surface, m
---@field cost? number as metres of ground; 0: its length, m
---@field bothWays? boolean
---@field closed? boolean not walked until it is opened
---@field kind? "jump"|"ladder"|"door" for whoever moves the agent

---Adds a way that leaves the surface: a jump, a ladder, a door. Returns its id.
---@param options Surface.addLink.options the link
---@return integer link
function Surface:addLink(options) end

---Removes a link.
---@param link integer which
function Surface:removeLink(link) end

---Opens or closes a link.
---@param link integer which
---@param open boolean may be walked
function Surface:setLinkOpen(link, open) end

---A link as a table {from, to, cost, bothWays, open, kind}.
---@param link integer which
---@return table link
function Surface:getLink(link) end

---Writes it to a file (.cnav), pieces and links included.
---@param path string in the player's folder, where corsac.save writes
function Surface:save(path) end

---The same as a Path.
---@param start number[] where it begins
---@param goal number[] where it ends
---@return corsac.Path path
function Surface:newPath(start, goal) end

---Area on the ground plane.
---@return number area
function Surface:getArea() end

---How many polygons it has.
---@return integer count
function Surface:getPolygonCount() end

---Draws its borders, seams and links for one frame.
---@param search? boolean also what the last search across it looked at
function Surface:draw(search) end

---Removes it; its paths and agents are left without a way.
function Surface:destroy() end

---Cells on which one steps.
---@class corsac.Grid
local Grid = {}

---Blocks or frees a cell.
---@param x integer column
---@param y integer row
---@param blocked boolean nobody steps there
function Grid:setBlocked(x, y, blocked) end

---Whether a cell is blocked; cells outside are.
---@param x integer column
---@param y integer row
---@return boolean blocked
function Grid:isBlocked(x, y) end

---How many cells it has along both sides.
---@return integer width
---@return integer height
function Grid:getSize() end

---@class Grid.findPath.options
---@field method? "jump"|"astar" jump point search, or A*

---Shortest way in steps to the eight neighbours: cells {x, y} (nil without one) and its length in cells. No corners are cut.
---@param x0 integer column of the start
---@param y0 integer its row
---@param x1 integer column of the goal
---@param y1 integer its row
---@param options? Grid.findPath.options how to search
---@return integer[][]? cells
---@return number length
function Grid:findPath(x0, y0, x1, y1, options) end

---Removes it.
function Grid:destroy() end

---Ways to one goal from everywhere.
---@class corsac.Flow
local Flow = {}

---The way from a point: points {x, y, z} (nil without one) and its length.
---@param from number[] where it begins
---@return number[][]? points
---@return number length
function Flow:findPath(from) end

---Removes it; agents that walk with it search for themselves.
function Flow:destroy() end

---Samples that sources play.
---@class corsac.Sound
local Sound = {}

---Its length.
---@return number duration
function Sound:getDuration() end

---One thing that sounds.
---@class corsac.Source
local Source = {}

---Starts it, or goes on after a pause.
function Source:play() end

---Holds it where it is.
function Source:pause() end

---Stops it; play begins at the start again.
function Source:stop() end

---Whether it plays, heard or not.
---@return boolean playing
function Source:isPlaying() end

---Where it is in its sound.
---@return number time
function Source:getTime() end

---Moves to a place in its sound.
---@param time number from the start
function Source:seek(time) end

---Moves it; one that hangs on an entity follows that instead.
---@param x number
---@param y number
---@param z number
function Source:setPosition(x, y, z) end

---Velocity for the Doppler effect.
---@param x number
---@param y number
---@param z number
function Source:setVelocity(x, y, z) end

---Axis of its cone.
---@param x number
---@param y number
---@param z number
function Source:setDirection(x, y, z) end

---Loudness; ends a fade.
---@param gain number factor of amplitude
function Source:setGain(gain) end

---Speed of playback.
---@param pitch number factor
function Source:setPitch(pitch) end

---Moves its gain over a time.
---@param gain number at the end
---@param seconds number of step time
---@param stop? boolean and then stops
function Source:fade(gain, seconds, stop) end

---Removes it.
function Source:destroy() end

---The run: parameters, time, log.
---@class corsac
---@field load? fun(args: string[])
---@field fixed? fun(dt: number)
---@field update? fun(dt: number)
---@field draw? fun()
---@field event? fun(name: string, ...)
---@field quit? fun()
---@field conf? fun(t: table)
---@field reload? fun(state: table)
corsac = {}

---A parameter of the scene: its default, or what --set NAME=VALUE gave.
---@param name string without a dot
---@param default any number, boolean or string; decides the type
---@return any value
function corsac.param(name, default) end

---Changes a setting of a room, as --set ROOM.NAME=VALUE does.
---@param name string room, dot, name: "phys.solver"
---@param value any number, boolean or string
function corsac.set(name, value) end

---Writes a line to the log (stderr); arguments are joined by spaces.
---@param ... any any values
function corsac.log(...) end

---As log, and the line stands in `warnings` of the metrics.
---@param ... any any values
function corsac.warn(...) end

---Ends the run after this callback.
---@param code? integer exit code
function corsac.exit(code) end

---Changes to another scene at the next step boundary.
---@param path string scene file or game folder
---@param data? table plain data; the next scene finds it in corsac.getRunData()
function corsac.run(path, data) end

---Stops or resumes the steps; update and draw go on.
---@param paused boolean true: no more steps
function corsac.setPaused(paused) end

---Speed of the loop against real time; the step itself keeps its length.
---@param scale number 1: real time
function corsac.setTimeScale(scale) end

---Simulated time since the start.
---@return number time
function corsac.getTime() end

---Steps done since the start.
---@return integer step
function corsac.getStep() end

---Length of a step.
---@return number dt
function corsac.getDt() end

---Seed of the run (--seed).
---@return integer seed
function corsac.getSeed() end

---Whether the run has no window.
---@return boolean headless
function corsac.isHeadless() end

---Checks that make a scene a test.
---@class corsac.expect
---@overload fun(metric: string, op: "<="|"<"|">="|">"|"=="|"~=", value: number)
corsac.expect = {}

---Checks a metric of the present step; if it falls short the run ends with exit code 3.
---@param metric string name in the metrics file, with dots
---@param op "<="|"<"|">="|">"|"=="|"~=" comparison
---@param value number bound
function corsac.expect.now(metric, op, value) end

---The run's figures.
corsac.metrics = {}

---Sets a figure of your own: `user.NAME` in the metrics.
---@param name string letters, digits, _
---@param value number the figure
function corsac.metrics.set(name, value) end

---A figure of the metrics by its name with dots, "counts.bodies".
---@param name string name in the metrics file
---@return number value
function corsac.metrics.get(name) end

---Keys, buttons, axes and actions, sampled once per step.
corsac.input = {}

---Whether a key, button or action is held at this step.
---@param name string "space", "a", "mouse1", "pad_a", an action
---@return boolean down
function corsac.input.isDown(name) end

---Value of an axis at this step: an action -1 to 1, a stick without its dead zone, the pointer and the wheel.
---@param name string an action, "pad_leftx", "mouse_x", "mouse_y" (pixels), "move_x", "move_y", "scroll_x", "scroll_y"
---@return number value
function corsac.input.getAxis(name) end

---Binds an action to other keys, in place of those of corsac.conf.
---@param action string a new name makes an action
---@param keys string separated by commas; - before one pulls the axis down: "-a,d,pad_leftx"
function corsac.input.bind(action, keys) end

---The keys of an action as bind takes them, nil for unknown actions.
---@param name string an action
---@return string? keys
function corsac.input.getBinding(name) end

---How the pointer shows in a window; locked: hidden and held, for turning a camera.
---@param mode "normal"|"hidden"|"locked"
function corsac.input.setCursor(mode) end

---Presses a key or button. As if a person did it: heard in the next step, recorded, ignored in a replay.
---@param name string of a key or button
function corsac.input.press(name) end

---Releases a key or button. As if a person did it: heard in the next step, recorded, ignored in a replay.
---@param name string of a key or button
function corsac.input.release(name) end

---Moves a stick or trigger of the gamepad. As if a person did it: heard in the next step, recorded, ignored in a replay.
---@param name string "pad_leftx", "pad_rt"
---@param value number stick -1 to 1, trigger 0 to 1
function corsac.input.setAxis(name, value) end

---Moves the pointer. As if a person did it: heard in the next step, recorded, ignored in a replay.
---@param x number
---@param y number
function corsac.input.move(x, y) end

---Types a text. As if a person did it: heard in the next step, recorded, ignored in a replay.
---@param name string UTF-8
function corsac.input.type(name) end

---Tasks of the step, events, containers.
---@class corsac
---@field load? fun(args: string[])
---@field fixed? fun(dt: number)
---@field update? fun(dt: number)
---@field draw? fun()
---@field event? fun(name: string, ...)
---@field quit? fun()
---@field conf? fun(t: table)
---@field reload? fun(state: table)
corsac = {}

---Calls a function once, after a time rounded up to whole steps.
---@param seconds number
---@param fn function called in the step
---@return corsac.Task task
function corsac.after(seconds, fn) end

---Calls a function again and again.
---@param seconds number between calls
---@param fn function called in the step
---@param times? integer how often
---@return corsac.Task task
function corsac.every(seconds, fn, times) end

---@class corsac.tween.options
---@field length number how long it takes, s
---@field target? table table whose numbers move
---@field goals? table names in target and where they go
---@field from? number first value for step
---@field to? number last value for step
---@field step? function called each step with the value
---@field done? function called at the end
---@field ease? "linear"|"smooth"|"in"|"out"|"bounce" how it moves

---Moves numbers from where they are to where they should be.
---@param options corsac.tween.options what moves, how and when
---@return corsac.Task task
function corsac.tween(options) end

---Starts a coroutine that lives in the step: it may call corsac.wait.
---@param fn function the coroutine's function
---@param ... any its arguments
---@return corsac.Task task
function corsac.spawn(fn, ...) end

---Inside corsac.spawn: goes on after a time (at least one step).
---@param seconds? number
function corsac.wait(seconds) end

---Inside corsac.spawn: goes on in the step after an event and gives its arguments.
---@param event string name, as given to corsac.emit
---@return any ...
function corsac.waitFor(event) end

---Ends a timer, tween or coroutine; false when it was over.
---@param task table what after, every, tween or spawn gave
---@return boolean cancelled
function corsac.cancel(task) end

---Listens to an event; a listener that returns false is not called again.
---@param name string of the event
---@param fn function called with the event's arguments
function corsac.on(name, fn) end

---Ends listening; false when it did not listen.
---@param name string of the event
---@param fn function the listener
---@return boolean found
function corsac.off(name, fn) end

---Calls an event's listeners now, in the order in which they began to listen.
---@param name string of the event
---@param ... any given to the listeners
---@return integer heard
function corsac.emit(name, ...) end

---A map with any keys, walked in order of insertion: set, get, has, count, each.
---@return corsac.Map map
function corsac.newMap() end

---A queue: push, pop, peek, count.
---@return corsac.Queue queue
function corsac.newQueue() end

---A priority queue, lowest first, oldest among equals: push, pop, count.
---@return corsac.Heap heap
function corsac.newHeap() end

---Text of a value for people: tables with their fields, sorted, at most 6 deep.
---@param value any anything
---@return string text
function corsac.inspect(value) end

---A table that survives hot reloads; made from the default at first.
---@param name string of the table
---@param default table its first contents
---@return table state
function corsac.persist(name, default) end

---Text of a file in the game's folder.
---@param path string relative, with /
---@return string text
function corsac.readFile(path) end

---What the former scene gave to corsac.run, or nil.
---@return table? data
function corsac.getRunData() end

---Prefabs.
corsac.scene = {}

---Keeps options of spawn for use again: prefab:spawn{...} with changes, prefab:with{...} for a variant; `children` lists prefab tables that hang on it.
---@param options table as for spawn, and children
---@return corsac.Prefab prefab
function corsac.scene.newPrefab(options) end

---Plain data as JSON.
corsac.json = {}

---JSON text of plain data; keys are sorted.
---@param value any numbers, strings, booleans and tables of these
---@return string text
function corsac.json.encode(value) end

---Data from JSON text.
---@param text string JSON
---@return any value
function corsac.json.decode(text) end

---The player's saved data: JSON files in a folder of the game's own.
corsac.save = {}

---Writes plain data to the player's folder, whole or not at all.
---@param name string letters, digits, - and _
---@param data table plain data
---@param version? integer of its form
function corsac.save.write(name, data, version) end

---@class corsac.save.read.options
---@field version? integer that this code writes
---@field migrate? function called with older data and its version; gives data of this version

---Data that was written under that name, or nil.
---@param name string as given to write
---@param options? corsac.save.read.options
---@return table? data
function corsac.save.read(name, options) end

---What only mods have.
corsac.mod = {}

---In mods: calls a function before an event of the game.
---@param name string load, fixed, update, draw, quit, or an event of the game
---@param fn function called with plain data
function corsac.mod.before(name, fn) end

---In mods: calls a function after an event of the game.
---@param name string load, fixed, update, draw, quit, or an event of the game
---@param fn function called with plain data
function corsac.mod.after(name, fn) end

---In mods: gives a function the value of a filter; what it returns replaces it.
---@param name string load, fixed, update, draw, quit, or an event of the game
---@param fn function called with plain data
function corsac.mod.filter(name, fn) end

---In mods: calls a function of a service that the game exports.
---@param service string "service.function"
---@param ... any plain data and objects
---@return any ...
function corsac.mod.call(service, ...) end

---In mods: merges a table into data that the game declares with corsac.mods.data.
---@param name string of the data
---@param changes table fields to add or replace
function corsac.mod.patch(name, changes) end

---In mods: a copy of the game's data of that name, or nil.
---@param name string of the data
---@return table? data
function corsac.mod.getData(name) end

---What a game offers to mods.
corsac.mods = {}

---The mods in order: name, version, enabled, errors, calls, instructions, bytes.
---@return table[] mods
function corsac.mods.list() end

---Switches a mod on or off from now on.
---@param name string of the mod
---@param on boolean
function corsac.mods.setEnabled(name, on) end

---Gives a value to the mods' filters of that name, in order, and returns what is left.
---@param name string of the filter
---@param value any plain data or an object
---@return any value
function corsac.mods.filter(name, value) end

---Offers functions to mods under a name; they get and give plain data and objects.
---@param name string of the service
---@param functions table name = function
function corsac.mods.export(name, functions) end

---Declares data that mods may patch, and returns it with their patches.
---@param name string of the data
---@param data table plain data
---@return table data
function corsac.mods.data(name, data) end

---Entities: places in the world that carry bodies and meshes.
corsac.scene = {}

---@class corsac.scene.spawn.options.body.shapes
---@field shape? "sphere"|"box"|"plane"|"capsule"|"cylinder"|"hull"|"mesh" geometry
---@field size? number|number[] box: lengths of its edges, m
---@field radius? number sphere, capsule, cylinder, m
---@field height? number cylinder: whole; capsule: its straight part, m
---@field normal? number[] plane: direction of its free side
---@field points? number[] hull, mesh: its corners, x y z after x y z, m
---@field triangles? number[] mesh: three corners each, counted from 1, counter-clockwise from the front
---@field heights? number[] mesh: a field of heights instead, row by row along +Z from its own place, m
---@field columns? integer heights in a row, along +X
---@field step? number[] of heights: from point to point along x and z, m
---@field cells? number[] of heights: 0 for each cell that is a hole, row by row
---@field oneSided? boolean mesh: what comes from behind passes
---@field density? number mass per volume, kg/m^3
---@field friction? number Coulomb's coefficient
---@field restitution? number share of the speed kept in a bounce
---@field rolling? number sphere: rolling resistance over the radius
---@field position? number[] in the body's frame, m
---@field rotation? number[]|corsac.AxisAngle in the body's frame

---@class corsac.scene.spawn.options.body
---@field shape? "sphere"|"box"|"plane"|"capsule"|"cylinder"|"hull"|"mesh" geometry
---@field size? number|number[] box: lengths of its edges, m
---@field radius? number sphere, capsule, cylinder, m
---@field height? number cylinder: whole; capsule: its straight part, m
---@field normal? number[] plane: direction of its free side
---@field points? number[] hull, mesh: its corners, x y z after x y z, m
---@field triangles? number[] mesh: three corners each, counted from 1, counter-clockwise from the front
---@field heights? number[] mesh: a field of heights instead, row by row along +Z from its own place, m
---@field columns? integer heights in a row, along +X
---@field step? number[] of heights: from point to point along x and z, m
---@field cells? number[] of heights: 0 for each cell that is a hole, row by row
---@field oneSided? boolean mesh: what comes from behind passes
---@field density? number mass per volume, kg/m^3
---@field friction? number Coulomb's coefficient
---@field restitution? number share of the speed kept in a bounce
---@field rolling? number sphere: rolling resistance over the radius
---@field shapes? corsac.scene.spawn.options.body.shapes[] several shapes in place of one
---@field type? "dynamic"|"static"|"kinematic" how it moves
---@field velocity? number[] at the start, m/s
---@field angularVelocity? number[] at the start, rad/s
---@field linearDamping? number loss of velocity, 1/s
---@field angularDamping? number loss of angular velocity, 1/s
---@field gravityScale? number factor on gravity
---@field locks? string world axes along and about which it never moves: any of x y z turnX turnY turnZ, spaces between
---@field layer? string name of its collision layer
---@field onContact? function called when it begins to touch: itself, the other body, speed of approach (m/s), normal x, y, z towards the other
---@field onContactEnd? function called when it touches no longer: itself, the other body (nil when it was destroyed)
---@field onHit? function called when it is struck again, at more than 1 m/s, while in touch: as onContact

---@class corsac.scene.spawn.options
---@field position? number[] in its parent's frame, m
---@field rotation? number[]|corsac.AxisAngle in its parent's frame
---@field scale? number|number[] of the mesh and of children
---@field parent? corsac.Entity entity it hangs on
---@field body? corsac.scene.spawn.options.body its rigid body
---@field mesh? string "box", "sphere", "capsule", "cylinder" or "plane"; takes the size of the body
---@field color? number[] multiplies the material's
---@field material? corsac.Material of its mesh
---@field model? corsac.Model shown in place of a mesh
---@field machine? corsac.Machine state machine that moves the model
---@field clip? corsac.Clip clip the model plays, without a machine
---@field name? string for corsac.scene.find
---@field tags? table names, for corsac.scene.findAll

---Makes an entity: a place in the world with a body, a mesh, or both.
---@param options corsac.scene.spawn.options the entity
---@return corsac.Entity entity
function corsac.scene.spawn(options) end

---The oldest entity of that name, or nil.
---@param name string as given to spawn
---@return corsac.Entity? entity
function corsac.scene.find(name) end

---How many entities there are.
---@return integer count
function corsac.scene.getCount() end

---@class corsac.scene.findAll.options
---@field tags? table names: has all of these
---@field without? table names: has none of these
---@field has? table has all of these: "body", "mesh", "animator", "agent", "sound"
---@field min? number[] corner of a box around its position, m
---@field max? number[] the other corner, m
---@field center? number[] of a ball around its position, m
---@field radius? number of that ball, m

---Entities by tags, components and place, in an order that every run repeats.
---@param options corsac.scene.findAll.options what they must have
---@return corsac.Entity[] entities
function corsac.scene.findAll(options) end

---Saves the whole scene at the end of this step in the player's folder: bodies, contacts, animations, agents, sources, lights, the tables of corsac.persist. Models, sounds, surfaces, machines and functions are not in it: they are what the scene's own code makes again.
---@param name string letters, digits, - and _
---@param form? "binary"|"lua" packed, or text a person can read
function corsac.scene.save(name, form) end

---Makes the scene what it was when it was saved, at the end of this step, then emits "loaded" with the name. To be called in the scene that wrote it, after load. A file that is damaged or of another scene is an error, and changes nothing.
---@param name string as given to save
---@return boolean found
function corsac.scene.load(name) end

---Rigid bodies: metres, kilograms, seconds, radians.
corsac.phys = {}

---Sets the acceleration of every body.
---@param x number
---@param y number
---@param z number
function corsac.phys.setGravity(x, y, z) end

---The acceleration of every body.
---@return number x
---@return number y
---@return number z
function corsac.phys.getGravity() end

---@class corsac.phys.newBody.options.shapes
---@field shape? "sphere"|"box"|"plane"|"capsule"|"cylinder"|"hull"|"mesh" geometry
---@field size? number|number[] box: lengths of its edges, m
---@field radius? number sphere, capsule, cylinder, m
---@field height? number cylinder: whole; capsule: its straight part, m
---@field normal? number[] plane: direction of its free side
---@field points? number[] hull, mesh: its corners, x y z after x y z, m
---@field triangles? number[] mesh: three corners each, counted from 1, counter-clockwise from the front
---@field heights? number[] mesh: a field of heights instead, row by row along +Z from its own place, m
---@field columns? integer heights in a row, along +X
---@field step? number[] of heights: from point to point along x and z, m
---@field cells? number[] of heights: 0 for each cell that is a hole, row by row
---@field oneSided? boolean mesh: what comes from behind passes
---@field density? number mass per volume, kg/m^3
---@field friction? number Coulomb's coefficient
---@field restitution? number share of the speed kept in a bounce
---@field rolling? number sphere: rolling resistance over the radius
---@field position? number[] in the body's frame, m
---@field rotation? number[]|corsac.AxisAngle in the body's frame

---@class corsac.phys.newBody.options
---@field shape? "sphere"|"box"|"plane"|"capsule"|"cylinder"|"hull"|"mesh" geometry
---@field size? number|number[] box: lengths of its edges, m
---@field radius? number sphere, capsule, cylinder, m
---@field height? number cylinder: whole; capsule: its straight part, m
---@field normal? number[] plane: direction of its free side
---@field points? number[] hull, mesh: its corners, x y z after x y z, m
---@field triangles? number[] mesh: three corners each, counted from 1, counter-clockwise from the front
---@field heights? number[] mesh: a field of heights instead, row by row along +Z from its own place, m
---@field columns? integer heights in a row, along +X
---@field step? number[] of heights: from point to point along x and z, m
---@field cells? number[] of heights: 0 for each cell that is a hole, row by row
---@field oneSided? boolean mesh: what comes from behind passes
---@field density? number mass per volume, kg/m^3
---@field friction? number Coulomb's coefficient
---@field restitution? number share of the speed kept in a bounce
---@field rolling? number sphere: rolling resistance over the radius
---@field shapes? corsac.phys.newBody.options.shapes[] several shapes in place of one
---@field type? "dynamic"|"static"|"kinematic" how it moves
---@field velocity? number[] at the start, m/s
---@field angularVelocity? number[] at the start, rad/s
---@field linearDamping? number loss of velocity, 1/s
---@field angularDamping? number loss of angular velocity, 1/s
---@field gravityScale? number factor on gravity
---@field locks? string world axes along and about which it never moves: any of x y z turnX turnY turnZ, spaces between
---@field layer? string name of its collision layer
---@field onContact? function called when it begins to touch: itself, the other body, speed of approach (m/s), normal x, y, z towards the other
---@field onContactEnd? function called when it touches no longer: itself, the other body (nil when it was destroyed)
---@field onHit? function called when it is struck again, at more than 1 m/s, while in touch: as onContact
---@field position? number[] origin, m
---@field rotation? number[]|corsac.AxisAngle

---Makes a body without an entity: it is drawn as a debug shape only.
---@param options corsac.phys.newBody.options the body
---@return corsac.Body body
function corsac.phys.newBody(options) end

---@class corsac.phys.columns.options
---@field checked? boolean checks every index and the view's age; slow

---All bodies as 0-based arrays px..pz, qx..qw, vx..vz, wx..wz of `n` rows, with row(body), handle(row) and touch(row); valid until the callback ends. Velocities may be written, followed by touch(row). A row out of range is not caught without `checked`.
---@param options? corsac.phys.columns.options
---@return corsac.Columns columns
function corsac.phys.columns(options) end

---How many bodies the world has.
---@return integer count
function corsac.phys.getBodyCount() end

---Whether bodies of two layers collide; without a rule they do.
---@param a string layer; a new name makes one (at most 32)
---@param b string layer, also the same one
---@param collide boolean from the next step
function corsac.phys.setCollisionRule(a, b, collide) end

---Whether bodies of two layers collide.
---@param a string layer; a new name makes one (at most 32)
---@param b string layer, also the same one
---@return boolean collide
function corsac.phys.getCollisionRule(a, b) end

---@class corsac.phys.newTrigger.options
---@field shape? "sphere"|"box"|"capsule"|"cylinder" form of the region
---@field size? number|number[] box: lengths of its edges, m
---@field radius? number sphere, capsule, cylinder, m
---@field height? number cylinder: whole; capsule: its straight part, m
---@field position? number[] of its centre, m
---@field rotation? number[]|corsac.AxisAngle of the region
---@field layer? string sees only bodies of this layer; without, all
---@field onEnter? function called with body and trigger, once a visit
---@field onStay? function in every step between
---@field onExit? function once a visit; body is nil when it was destroyed

---Makes a region that calls back when bodies come and go.
---@param options corsac.phys.newTrigger.options the trigger
---@return corsac.Trigger trigger
function corsac.phys.newTrigger(options) end

---@class corsac.phys.newField.options
---@field type? "uniform"|"point"|"wind" kind of field
---@field acceleration? number[] uniform, m/s^2
---@field velocity? number[] wind: of the air, which drags cloth and ropes along, m/s
---@field center? number[] point: what it pulls towards, m
---@field strength? number point: acceleration times distance squared; negative repels, m^3/s^2
---@field core? number point: inside this distance the pull falls to zero, m
---@field shape? "sphere"|"box"|"capsule"|"cylinder" acts only inside this region
---@field size? number|number[] box: lengths of its edges, m
---@field radius? number sphere, capsule, cylinder, m
---@field height? number cylinder: whole; capsule: its straight part, m
---@field position? number[] of the region's centre, m
---@field rotation? number[]|corsac.AxisAngle of the region
---@field layer? string acts only on bodies of this layer; without, on all

---Makes a force field.
---@param options corsac.phys.newField.options the field
---@return corsac.Field field
function corsac.phys.newField(options) end

---@class corsac.phys.rayCast.options
---@field layer? string sees only bodies of this layer; without, all
---@field skip? corsac.Body a body that is not seen

---Nearest body on the way, where it is hit, its normal there, and the part of the way.
---@param x number from here
---@param y number
---@param z number
---@param dx number as far as this
---@param dy number
---@param dz number
---@param options? corsac.phys.rayCast.options what is seen
---@return corsac.Body? body
---@return number x
---@return number y
---@return number z
---@return number nx
---@return number ny
---@return number nz
---@return number fraction
function corsac.phys.rayCast(x, y, z, dx, dy, dz, options) end

---@class corsac.phys.sphereCast.options
---@field layer? string sees only bodies of this layer; without, all
---@field skip? corsac.Body a body that is not seen

---As rayCast, with a ball that is carried along the way.
---@param x number from here
---@param y number
---@param z number
---@param radius number of the ball
---@param dx number as far as this
---@param dy number
---@param dz number
---@param options? corsac.phys.sphereCast.options what is seen
---@return corsac.Body? body
---@return number x
---@return number y
---@return number z
---@return number nx
---@return number ny
---@return number nz
---@return number fraction
function corsac.phys.sphereCast(x, y, z, radius, dx, dy, dz, options) end

---@class corsac.phys.closest.options
---@field layer? string sees only bodies of this layer; without, all
---@field skip? corsac.Body a body that is not seen

---Closest point of any body within a distance.
---@param x number from here
---@param y number
---@param z number
---@param radius number farthest distance
---@param options? corsac.phys.closest.options what is seen
---@return corsac.Body? body
---@return number x
---@return number y
---@return number z
---@return number nx
---@return number ny
---@return number nz
---@return number distance
function corsac.phys.closest(x, y, z, radius, options) end

---@class corsac.phys.overlapSphere.options
---@field layer? string sees only bodies of this layer; without, all
---@field skip? corsac.Body a body that is not seen

---The bodies that a ball overlaps, at most 256 of them.
---@param x number from here
---@param y number
---@param z number
---@param radius number of the ball
---@param options? corsac.phys.overlapSphere.options what is seen
---@return corsac.Body[] bodies
function corsac.phys.overlapSphere(x, y, z, radius, options) end

---@class corsac.phys.newJoint.options
---@field type "fixed"|"ball"|"distance"|"revolute"|"prismatic"|"universal"|"pivot"|"pulley" kind of joint
---@field a? corsac.Body without, the world
---@field b? corsac.Body without, the world
---@field anchor? number[] place in the world; distance, pulley: on a, m
---@field anchorB? number[] distance, pulley: on b, m
---@field axis? number[] direction in the world
---@field axisB? number[] universal (+x), pivot (axis): that of b
---@field lower? number ball (twist), distance, revolute, prismatic, universal, pulley (a's side), m or rad
---@field upper? number with lower; alone for a rope, m or rad
---@field cone? number ball: largest lean of the axis; universal: turn about axisB to either side; 0 for none, rad
---@field motorSpeed? number of b against a, m/s or rad/s
---@field motorMax? number most the motor gives, N or N m
---@field hertz? number spring; 0 for none, Hz
---@field rest? number of the spring; distance: 0 is the present one, m or rad
---@field dampingRatio? number of the spring
---@field damping? number without a spring as well, N s/m or N m s/rad
---@field ratio? number pivot: turns of a for one of b; pulley: pull on b over a
---@field groundA? number[] pulley: wheel above a, m
---@field groundB? number[] pulley: wheel above b, m
---@field breakForce? number breaks beyond; 0 for never, N
---@field breakTorque? number breaks beyond; 0 for never, N m
---@field collide? boolean a and b touch as if not joined
---@field onBreak? function called with a and b (nil: the world or destroyed) when it breaks or one is destroyed

---Joins two bodies, or a body and the world.
---@param options corsac.phys.newJoint.options the joint
---@return corsac.Joint joint
function corsac.phys.newJoint(options) end

---How many joints the world has.
---@return integer count
function corsac.phys.getJointCount() end

---@class corsac.phys.newMover.options
---@field position? number[] centre of the capsule, m
---@field radius? number m
---@field height? number in all, m
---@field slopeLimit? number steepest ground it stands on, rad
---@field stepHeight? number highest edge it walks over, m
---@field pushForce? number most it gives against dynamic bodies, N
---@field mass? number weighs on what it stands on, kg
---@field gravityScale? number 0 flies
---@field layers? table names of the layers in its way

---Makes a character that walks by its own rules at the end of each step.
---@param options corsac.phys.newMover.options the mover
---@return corsac.Mover mover
function corsac.phys.newMover(options) end

---Where everything is and how it moves, as a string, for restoreState.
---@return string state
function corsac.phys.saveState() end

---Goes back to a saved state; the world then goes on with the same bits. The bodies must be those of then.
---@param state any from saveState
function corsac.phys.restoreState(state) end

---@class corsac.phys.newCloth.options
---@field columns integer particles across
---@field rows integer particles down
---@field position? number[] of the particle (1, 1), m
---@field across number[] way from the first column to the last, m
---@field down number[] way from the first row to the last, m
---@field shear? number how far a diagonal gives, m/N
---@field mass? number in all, kg
---@field radius? number half the thickness, m
---@field stretch? number how far an edge gives; 0: not at all, m/N
---@field bend? number stiffness against bending; 0 for none, N/m
---@field friction? number Coulomb's coefficient
---@field damping? number loss of velocity, 1/s
---@field drag? number of the air; 0 feels no wind
---@field gravityScale? number factor on gravity
---@field tearForce? number tears an edge; 0 for never, N
---@field substeps? integer more are stiffer and cost more
---@field layer? string name of its collision layer

---Makes a sheet of cloth.
---@param options corsac.phys.newCloth.options the cloth
---@return corsac.Cloth cloth
function corsac.phys.newCloth(options) end

---@class corsac.phys.newRope.options
---@field count integer particles
---@field from number[] of the particle (1, 1), m
---@field to number[] of the last one, m
---@field mass? number in all, kg
---@field radius? number half the thickness, m
---@field stretch? number how far an edge gives; 0: not at all, m/N
---@field bend? number stiffness against bending; 0 for none, N/m
---@field friction? number Coulomb's coefficient
---@field damping? number loss of velocity, 1/s
---@field drag? number of the air; 0 feels no wind
---@field gravityScale? number factor on gravity
---@field tearForce? number tears an edge; 0 for never, N
---@field substeps? integer more are stiffer and cost more
---@field layer? string name of its collision layer

---Makes a rope: a cloth of one column, its particles (1, 1) to (1, count).
---@param options corsac.phys.newRope.options the rope
---@return corsac.Cloth rope
function corsac.phys.newRope(options) end

---@class corsac.phys.newRagdoll.options.bones
---@field parent? integer number of an earlier bone; without, a root
---@field head number[] place of its joint, in the world, m
---@field tail number[] its other end, m
---@field rotation? number[]|corsac.AxisAngle of its body
---@field radius? number of its capsule; 0: 0.15 of the length, m
---@field mass? number 0: as of water, kg
---@field cone? number largest lean against the parent, rad
---@field twist? number to either side, rad
---@field axis? number[] a hinge about this direction instead of cone and twist
---@field lower? number of the hinge, from this pose, rad
---@field upper? number of the hinge, from this pose, rad

---@class corsac.phys.newRagdoll.options
---@field bones corsac.phys.newRagdoll.options.bones[] parents before children
---@field layer? string name of its collision layer
---@field friction? number Coulomb's coefficient
---@field linearDamping? number loss of velocity, 1/s
---@field angularDamping? number loss of angular velocity, 1/s

---Makes a body a bone, its origin at the bone's head, and the joints between: lists in the order of the bones, joints false for roots.
---@param options corsac.phys.newRagdoll.options the ragdoll
---@return corsac.Body[] bodies
---@return (corsac.Joint|false)[] joints
function corsac.phys.newRagdoll(options) end

---Camera, lights and what is drawn over the frame.
corsac.gfx = {}

---Colour where nothing is drawn.
---@param r number linear
---@param g number linear
---@param b number linear
function corsac.gfx.setBackground(r, g, b) end

---Light that comes from everywhere.
---@param r number linear
---@param g number linear
---@param b number linear
function corsac.gfx.setAmbient(r, g, b) end

---@class corsac.gfx.newLight.options
---@field type? "point"|"spot"|"directional" kind of source
---@field position? number[] point, spot, m
---@field direction? number[] spot, directional: where the light goes
---@field color? number[] linear
---@field intensity? number point, spot: radiant intensity; directional: irradiance
---@field radius? number point, spot: no light beyond, m
---@field inner? number spot: half angle of full light, rad
---@field outer? number spot: half angle of any light, rad
---@field shadows? boolean casts shadows
---@field source? number for soft shadows: radius of the source in m, of a sun the tangent of its angular radius

---Makes a light.
---@param options corsac.gfx.newLight.options the light
---@return corsac.Light light
function corsac.gfx.newLight(options) end

---@class corsac.gfx.newMaterial.options
---@field baseColor? number[] linear, and coverage
---@field metallic? number 0 or 1 but where things mix
---@field roughness? number 0 is a mirror
---@field emissive? number[] radiance sent out
---@field alpha? "opaque"|"mask"|"blend" what coverage means
---@field cutoff? number mask: least coverage that is drawn
---@field doubleSided? boolean seen from behind too
---@field normalScale? number of the normal map
---@field occlusion? number strength of the occlusion map
---@field baseColorMap? string image file, sRGB
---@field normalMap? string image file, +Y up
---@field metallicRoughnessMap? string image file: green rough, blue metallic
---@field occlusionMap? string image file: red
---@field emissiveMap? string image file, sRGB
---@field fragment? string shader file with void surface(inout Look look); not for mods
---@field parameters? number[] parameter(0) to parameter(15) of the shader

---Makes a material.
---@param options corsac.gfx.newMaterial.options the material
---@return corsac.Material material
function corsac.gfx.newMaterial(options) end

---@class corsac.gfx.setEnvironment.options
---@field panorama? string equirectangular image file in place of the sky
---@field intensity? number factor
---@field zenith? number[] radiance from above
---@field horizon? number[] radiance from the horizon
---@field ground? number[] radiance from below
---@field glow? number[] radiance round the sun
---@field glowExponent? number the larger the narrower
---@field sun? number[] direction to the sun

---Lights the world by a sky or a panorama, seen behind everything.
---@param options corsac.gfx.setEnvironment.options the environment
function corsac.gfx.setEnvironment(options) end

---Changes a setting, as --set gfx.NAME=VALUE does.
---@param name string such as shadows, bloom, lift
---@param value any such as "soft", 0.2, true, {0.1, 0, 0}
function corsac.gfx.set(name, value) end

---How lights are assigned to what they light.
---@param method "auto"|"forward"|"clustered"|"none"
function corsac.gfx.setRender(method) end

---Writes text over the frame; the origin is its top left corner.
---@param text string UTF-8
---@param x number left
---@param y number top
---@param size? number height of a line
---@param color? number[] sRGB
function corsac.gfx.print(text, x, y, size, color) end

---Fills a rectangle over the frame.
---@param x number left
---@param y number top
---@param w number width
---@param h number height
---@param color? number[] sRGB
function corsac.gfx.rect(x, y, w, h, color) end

---Draws an image file over the frame.
---@param path string in the game's folder
---@param x number left
---@param y number top
---@param w number width
---@param h number height
function corsac.gfx.image(path, x, y, w, h) end

---Cameras and views.
corsac.gfx = {}

---@class corsac.gfx.setCamera.options
---@field position? number[] of the eye, m
---@field target? number[] point it looks at, m
---@field rotation? number[]|corsac.AxisAngle in place of target; looks along -Z
---@field fov? number vertical field of view, rad
---@field near? number nearest visible distance, m
---@field far? number no point or spot light is seen beyond, m
---@field height? number of what is seen without perspective; 0: with perspective, m

---Places the camera.
---@param options corsac.gfx.setCamera.options the camera
function corsac.gfx.setCamera(options) end

---Puts the camera at x, y, z, looking at tx, ty, tz.
---@param x number
---@param y number
---@param z number
---@param tx number
---@param ty number
---@param tz number
function corsac.gfx.lookAt(x, y, z, tx, ty, tz) end

---Position and rotation of the camera.
---@return number x
---@return number y
---@return number z
---@return number qx
---@return number qy
---@return number qz
---@return number qw
function corsac.gfx.getCamera() end

---@class corsac.gfx.newView.options
---@field position? number[] of the eye, m
---@field target? number[] point it looks at, m
---@field rotation? number[]|corsac.AxisAngle in place of target; looks along -Z
---@field fov? number vertical field of view, rad
---@field near? number nearest visible distance, m
---@field far? number no point or spot light is seen beyond, m
---@field height? number of what is seen without perspective; 0: with perspective, m
---@field rect? number[] x, y, width, height: shares of the picture, origin top left
---@field texture? string name of a texture in place of the picture: maps and images have it as "target:NAME"
---@field size? number[] width, height of the texture, pixels

---Makes a view: a part of the picture, in place of what the camera sees, or a texture.
---@param options corsac.gfx.newView.options the view
---@return corsac.View view
function corsac.gfx.newView(options) end

---Passes over the picture.
corsac.gfx = {}

---@class corsac.gfx.newEffect.options
---@field fragment string shader file with vec3 effect(vec2 uv), which may call picture(uv), depth(uv), size(), parameter(i)
---@field encoded? boolean on the picture after the tone map, not on linear light before it
---@field parameters? number[] parameter(0) to parameter(15) of the shader

---Adds a pass over each view's picture by a shader of the game.
---@param options corsac.gfx.newEffect.options the pass
---@return corsac.Effect effect
function corsac.gfx.newEffect(options) end

---Shapes, sprites and text over the frame; places on the screen.
corsac.gfx = {}

---Fills a rectangle with smooth, rounded corners over the frame, or frames it.
---@param x number left
---@param y number top
---@param w number width
---@param h number height
---@param radius number of the corners
---@param color? number[] sRGB
---@param border? number width of a frame on the inside; 0: filled
function corsac.gfx.roundRect(x, y, w, h, radius, color, border) end

---Draws a line over the frame.
---@param x0 number start
---@param y0 number start
---@param x1 number end
---@param y1 number end
---@param width? number
---@param color? number[] sRGB
function corsac.gfx.line(x0, y0, x1, y1, width, color) end

---@class corsac.gfx.sprite.options
---@field x? number where the pivot lies, pixels
---@field y? number where the pivot lies, pixels
---@field w? number width, pixels
---@field h? number height, pixels
---@field source? number[] {x, y, width, height} of the part of the image, texels
---@field pivotX? number share of the width
---@field pivotY? number share of the height
---@field angle? number clockwise about the pivot, rad
---@field color? number[] sRGB

---Draws an image file, or a part of it, turned and tinted, over the frame.
---@param path string in the game's folder
---@param options? corsac.gfx.sprite.options where and how
function corsac.gfx.sprite(path, options) end

---@class corsac.gfx.text.options
---@field x? number left, pixels
---@field y? number top, pixels
---@field size? number height of a line, pixels
---@field width? number lines break to stay within, pixels
---@field align? number of lines in the width, or about x without one: 0 left, 0.5 middle, 1 right
---@field font? string "mono", "sans", or a TrueType file of the game
---@field color? number[] sRGB

---Writes text over the frame, with a font, lines that break, and alignment.
---@param text string UTF-8
---@param options? corsac.gfx.text.options where and how
function corsac.gfx.text(text, options) end

---@class corsac.gfx.measure.options
---@field x? number left, pixels
---@field y? number top, pixels
---@field size? number height of a line, pixels
---@field width? number lines break to stay within, pixels
---@field align? number of lines in the width, or about x without one: 0 left, 0.5 middle, 1 right
---@field font? string "mono", "sans", or a TrueType file of the game
---@field color? number[] sRGB

---What a text will take: width and height in pixels, and lines.
---@param text string UTF-8
---@param options? corsac.gfx.measure.options where and how
---@return number width
---@return number height
---@return integer lines
function corsac.gfx.measure(text, options) end

---What follows is drawn only inside a rectangle, and inside those pushed before.
---@param x number left
---@param y number top
---@param w number width
---@param h number height
function corsac.gfx.pushClip(x, y, w, h) end

---Ends what the last pushClip began.
function corsac.gfx.popClip() end

---Size of the frame.
---@return number width
---@return number height
function corsac.gfx.getSize() end

---The ray through a point of the frame: its origin and unit direction.
---@param x number from the left
---@param y number from the top
---@return number x
---@return number y
---@return number z
---@return number dx
---@return number dy
---@return number dz
function corsac.gfx.getRay(x, y) end

---Where a point of the world is in the frame, and how far ahead of the camera.
---@param x number
---@param y number
---@param z number
---@return number x
---@return number y
---@return number depth
function corsac.gfx.project(x, y, z) end

---Menus of buttons, sliders, lists and text fields.
corsac.ui = {}

---Makes a menu: a column of widgets with focus by pointer, keys and gamepad. Give it events with panel:event(...) and draw it with panel:draw(); panel:get(name), panel:set(name, value), panel:focus(name), panel:show(on), panel:isShown().
---@param options table x, y, width, height, title, theme, shown, and widgets as list items: {type = "label|button|toggle|slider|list|field|gap", name, text, value, ...}
---@return corsac.Panel panel
function corsac.ui.newPanel(options) end

---Lines and shapes in the world, for one frame.
corsac.gfx = {}

---@class corsac.gfx.drawLine.pen
---@field color? number[] linear
---@field width? number pixels
---@field onTop? boolean seen through everything

---Draws a line in the world, in this frame.
---@param a number[] start
---@param b number[] end
---@param pen? corsac.gfx.drawLine.pen how
function corsac.gfx.drawLine(a, b, pen) end

---@class corsac.gfx.drawArrow.pen
---@field color? number[] linear
---@field width? number pixels
---@field onTop? boolean seen through everything

---Draws an arrow in the world, in this frame.
---@param a number[] start
---@param b number[] tip
---@param pen? corsac.gfx.drawArrow.pen how
function corsac.gfx.drawArrow(a, b, pen) end

---@class corsac.gfx.drawPath.pen
---@field color? number[] linear
---@field width? number pixels
---@field onTop? boolean seen through everything

---Draws lines from point to point in the world, in this frame.
---@param points number[] x, y, z of each
---@param pen? corsac.gfx.drawPath.pen how
function corsac.gfx.drawPath(points, pen) end

---@class corsac.gfx.drawBox.pen
---@field color? number[] linear
---@field width? number pixels
---@field onTop? boolean seen through everything

---Draws the edges of a box in the world, in this frame.
---@param center number[]
---@param size number[] whole edges
---@param pen? corsac.gfx.drawBox.pen how
---@param rotation? number[]|corsac.AxisAngle
function corsac.gfx.drawBox(center, size, pen, rotation) end

---@class corsac.gfx.drawSphere.pen
---@field color? number[] linear
---@field width? number pixels
---@field onTop? boolean seen through everything

---Draws three circles of a sphere in the world, in this frame.
---@param center number[]
---@param radius number
---@param pen? corsac.gfx.drawSphere.pen how
function corsac.gfx.drawSphere(center, radius, pen) end

---@class corsac.gfx.drawCapsule.pen
---@field color? number[] linear
---@field width? number pixels
---@field onTop? boolean seen through everything

---Draws the outline of a capsule in the world, in this frame.
---@param a number[] centre of one end
---@param b number[] centre of the other
---@param radius number
---@param pen? corsac.gfx.drawCapsule.pen how
function corsac.gfx.drawCapsule(a, b, radius, pen) end

---@class corsac.gfx.drawGrid.pen
---@field color? number[] linear
---@field width? number pixels
---@field onTop? boolean seen through everything

---Draws a level grid in the world, in this frame.
---@param center number[]
---@param size number whole edge
---@param cells integer along an edge
---@param pen? corsac.gfx.drawGrid.pen how
function corsac.gfx.drawGrid(center, size, cells, pen) end

---Particles, and pictures and texts in the world.
corsac.gfx = {}

---@class corsac.gfx.newEmitter.options
---@field position? number[] m
---@field rotation? number[]|corsac.AxisAngle takes +Y to where particles fly
---@field shape? "point"|"sphere"|"box" where they are born
---@field extent? number[] half, of a sphere or box, m
---@field rate? number births, 1/s
---@field burst? integer births at once
---@field capacity? integer alive at once; the oldest make room
---@field life? number[] {least, most}, s
---@field speed? number[] {least, most}, m/s
---@field spread? number half angle round the direction; pi: everywhere, rad
---@field acceleration? number[] m/s^2
---@field wind? number[] speed that drag leads to, m/s
---@field drag? number 1/s
---@field spin? number[] {least, most}; then the first angle is random, rad/s
---@field size? number[] edge, over life: up to 8 evenly spaced, m
---@field sizeVary? number part by which sizes of particles differ
---@field colors? number[] linear r, g, b, a over life: up to 8 times four numbers
---@field image? string image file; none: a soft disc
---@field columns? integer of frames in the image, shown over life
---@field rows? integer of frames in the image
---@field additive? boolean light that is added, as of fire; else it covers, as smoke
---@field seed? integer of its random numbers

---Makes a source of particles. They change no simulation, and a particle's way depends on its birth and its age alone.
---@param options corsac.gfx.newEmitter.options the emitter
---@return corsac.Emitter emitter
function corsac.gfx.newEmitter(options) end

---@class corsac.gfx.drawSprite.options
---@field position number[] of its middle, m
---@field height? number of a text: of a line, m
---@field width? number of a picture, m
---@field facing? "viewer"|"upright"|"fixed" turns to the viewer, turns about +Y only, or stands as rotation says
---@field rotation? number[]|corsac.AxisAngle fixed: from a front along +Z
---@field color? number[] linear
---@field font? string as for text
---@field source? number[] {x, y, width, height} of the part of the image, texels
---@field additive? boolean light that is added

---Draws an image file in the world, in this frame.
---@param path string in the game's folder
---@param options corsac.gfx.drawSprite.options where and how
function corsac.gfx.drawSprite(path, options) end

---@class corsac.gfx.drawText.options
---@field position number[] of its middle, m
---@field height? number of a text: of a line, m
---@field width? number of a picture, m
---@field facing? "viewer"|"upright"|"fixed" turns to the viewer, turns about +Y only, or stands as rotation says
---@field rotation? number[]|corsac.AxisAngle fixed: from a front along +Z
---@field color? number[] linear
---@field font? string as for text
---@field source? number[] {x, y, width, height} of the part of the image, texels
---@field additive? boolean light that is added

---Writes a text in the world, in this frame.
---@param text string UTF-8; \n starts a line
---@param options corsac.gfx.drawText.options where and how
function corsac.gfx.drawText(text, options) end

---Terrain.
corsac.gfx = {}

---Heights from the grey of an image, of 8 or 16 bits, for newTerrain and for bodies: their list and how many are in a row.
---@param path string in the game's folder
---@param low number of black
---@param high number of white
---@return number[] heights
---@return integer columns
function corsac.gfx.readHeights(path, low, high) end

---@class corsac.gfx.newTerrain.options
---@field heights number[] row by row along +Z, m
---@field columns integer heights in a row, along +X
---@field step? number[] from point to point along x and z, m
---@field position? number[] where the first point is when its height is 0, m
---@field low? number[] base colour, linear
---@field high? number[] base colour of what is high
---@field steep? number[] base colour of what is steep
---@field heightsBlend? number[] {from, to}: low turns into high, m
---@field slopesBlend? number[] {from, to}, rise over run: flat turns into steep
---@field image? string image file that multiplies the colours, stretched over the whole
---@field roughness? number 0 is a mirror

---Makes ground from a field of heights. It is drawn as finely as gfx.set("terrain_error", pixels) asks for.
---@param options corsac.gfx.newTerrain.options the terrain
---@return corsac.Terrain terrain
function corsac.gfx.newTerrain(options) end

---Skeletons, clips and state machines.
corsac.anim = {}

---Reads a .cmodel with its meshes, skeleton and clips; once for each path.
---@param path string virtual path
---@return corsac.Model model
function corsac.anim.loadModel(path) end

---@class corsac.anim.newSkeleton.bones
---@field name string of the bone
---@field parent? string a bone listed before it
---@field position? number[] in its parent's frame, m
---@field rotation? number[]|corsac.AxisAngle in its parent's frame
---@field scale? number|number[]

---Makes a skeleton from its bones.
---@param bones corsac.anim.newSkeleton.bones[] parents before children
---@return corsac.Skeleton skeleton
function corsac.anim.newSkeleton(bones) end

---@class corsac.anim.newClip.options.keys
---@field bone string which bone it moves
---@field time number place in the clip; ascending for each bone, s
---@field position? number[] in its parent's frame, m
---@field rotation? number[]|corsac.AxisAngle in its parent's frame
---@field scale? number|number[]

---@class corsac.anim.newClip.options.events
---@field time number place in the clip, s
---@field name string told by corsac.anim.getEvents

---@class corsac.anim.newClip.options
---@field skeleton corsac.Skeleton whose bones it moves
---@field name? string
---@field duration number its length, s
---@field keys corsac.anim.newClip.options.keys[] keys of its bones
---@field interpolation? "linear"|"step"|"cubic" between keys; cubic is smooth through all of them
---@field events? corsac.anim.newClip.options.events[] names told at times
---@field rootMotion? boolean the root's horizontal movement moves the entity
---@field root? string bone of the root motion

---Makes a clip from keys.
---@param options corsac.anim.newClip.options the clip
---@return corsac.Clip clip
function corsac.anim.newClip(options) end

---@class corsac.anim.newMachine.options.states.blend
---@field clip corsac.Clip
---@field value number of the parameter at which it plays alone

---@class corsac.anim.newMachine.options.states
---@field name string unique in the machine
---@field within? string a state listed before it, without clip and blend, that holds this one: a machine in a state; the first held is where it is entered
---@field clip? corsac.Clip what it plays
---@field blend? corsac.anim.newMachine.options.states.blend[] in place of clip: looping clips between which a parameter blends, values ascending
---@field blendParameter? string a parameter of the machine
---@field loop? "loop"|"once"|"pingpong" what happens at the clip's end
---@field speed? number factor on time; negative: backwards
---@field onEnter? function called with the animator
---@field onExit? function called with the animator
---@field onTick? function called each step with the animator and dt
---@field getSpeed? function gives a factor on time; called with the animator and the phase from 0 to 1

---@class corsac.anim.newMachine.options.transitions
---@field from? string state it leaves, or any within it (nil: any other)
---@field to string state it enters
---@field condition? function called each step with the animator; true starts it
---@field event? string starts when sent
---@field parameter? string starts when it compares so with value
---@field compare? ">"|"<"|">="|"<="|"=="|"~="
---@field value? number
---@field length? number of the cross-fade, s
---@field fade? "linear"|"smooth" shape of the cross-fade
---@field uninterruptible? boolean no other transition starts before its end
---@field sync? boolean the target starts at the same phase

---@class corsac.anim.newMachine.options
---@field initial? string state it starts in
---@field states corsac.anim.newMachine.options.states[]
---@field transitions? corsac.anim.newMachine.options.transitions[] the first that matches goes
---@field parameters? table names with their first values

---Makes a state machine; many animators may share it.
---@param options corsac.anim.newMachine.options the machine
---@return corsac.Machine machine
function corsac.anim.newMachine(options) end

---Which bones a layer moves: those named and all below them.
---@param skeleton corsac.Skeleton
---@param bones table list of names
---@param weight? number
---@return corsac.Mask mask
function corsac.anim.newMask(skeleton, bones, weight) end

---Moves a skeleton without an entity.
---@param skeleton corsac.Skeleton what it moves
---@param machine? corsac.Machine chooses its clips
---@param clip? corsac.Clip played without a machine
---@return corsac.Animator animator
function corsac.anim.newAnimator(skeleton, machine, clip) end

---Clip events passed in the last step: tables {animator, name, time}.
---@return table[] events
function corsac.anim.getEvents() end

---Waypoint graphs, walkable surfaces, paths and agents.
corsac.nav = {}

---@class corsac.nav.newGraph.options
---@field name? string for its text and errors
---@field maxLinks? integer links one node may have

---Makes an empty waypoint graph.
---@param options? corsac.nav.newGraph.options the graph
---@return corsac.Graph graph
function corsac.nav.newGraph(options) end

---Plans a way between two points by way of the nodes nearest to them.
---@param graph corsac.Graph on which
---@param start number[] where it begins
---@param goal number[] where it ends
---@return corsac.Path path
function corsac.nav.newPath(graph, start, goal) end

---@class corsac.nav.newAgent.options
---@field entity? corsac.Entity whom it leads: without a body it goes where the agent goes, a body is pushed along
---@field mover? corsac.Mover whose walk it decides
---@field position? number[] where it stands, without entity or mover, m
---@field offset? number height of the origin of entity or mover above its feet, m
---@field radius? number room it needs, m
---@field maxSpeed? number m/s
---@field acceleration? number braking too, m/s^2
---@field turnRate? number 0: turns at once, rad/s
---@field arrive? number how near to the goal it stops, m
---@field heading? number about +Y, 0 looks along -Z, rad

---Makes an agent; with an entity, it leads that entity or its body.
---@param options corsac.nav.newAgent.options the agent
---@return corsac.Agent agent
function corsac.nav.newAgent(options) end

---@class corsac.nav.newSurface.options.boxes
---@field position? number[] its middle, m
---@field size number|number[] lengths of its edges, m
---@field area? integer 0 to 31, or 255 where nobody walks

---@class corsac.nav.newSurface.options
---@field from? "geometry"|"physics" physics: static bodies, also those made, moved or destroyed later
---@field vertices? number[] x y z after x y z, m
---@field triangles? number[] three vertices each, counted from 1, counter-clockwise seen from above
---@field areas? number[] of each triangle: 0 to 31, or 255 where nobody walks
---@field boxes? corsac.nav.newSurface.options.boxes[] upright boxes
---@field cellSize? number how exact it is sideways, m
---@field maxError? number in place of cellSize: ground further than radius + maxError from walls is covered, m
---@field radius? number of the agent; kept clear of walls and ledges, m
---@field height? number of the agent, m
---@field climb? number highest step, m
---@field slope? number steepest ground, rad
---@field tileCells? integer side of a tile in cells: a change makes only its tiles anew; 0: one that cannot change
---@field tilesPerStep? integer made anew in a step at most
---@field low? number[] with tiles: corner of what it may ever cover, m
---@field high? number[] the opposite corner, m
---@field layers? table from physics: names of collision layers that count
---@field kinematic? boolean from physics: kinematic bodies count where they have rested for six steps
---@field tolerance? number from physics: by which round shapes may be cut flat, m

---Finds the ground on which an agent can stand and step, from triangles and boxes.
---@param options corsac.nav.newSurface.options world and agent
---@return corsac.Surface surface
function corsac.nav.newSurface(options) end

---Makes a grid of cells, for searches that step from cell to cell.
---@param width integer cells
---@param height integer cells
---@return corsac.Grid grid
function corsac.nav.newGrid(width, height) end

---Finds the shortest ways from everywhere on a surface to one goal.
---@param surface corsac.Surface on which
---@param goal number[] where they end
---@return corsac.Flow flow
function corsac.nav.newFlow(surface, goal) end

---Draws agents, their velocities and wishes, and all paths for one frame.
function corsac.nav.drawAgents() end

---Reads a surface that Surface:save wrote.
---@param path string a .cnav file of the scene or of the player's folder
---@return corsac.Surface surface
function corsac.nav.loadSurface(path) end

---Sounds in space: sources, groups, a listener.
corsac.audio = {}

---Reads a WAV or Ogg Vorbis file; the same path gives the same sound.
---@param path string in the game's folder
---@return corsac.Sound sound
function corsac.audio.newSound(path) end

---@class corsac.audio.newSource.options
---@field sound corsac.Sound what it plays
---@field entity? corsac.Entity that it follows and ends with
---@field position? number[] m
---@field velocity? number[] for the Doppler effect, m/s
---@field direction? number[] axis of the cone; zero: the same all around
---@field gain? number factor of amplitude
---@field pitch? number factor of speed
---@field reference? number distance of full loudness, m
---@field maxDistance? number beyond it the loudness stays, m
---@field rolloff? number 0: distance does not matter
---@field inner? number full angle of full loudness, rad
---@field outer? number full angle of the cone, rad
---@field coneGain? number factor outside the cone
---@field loop? boolean again and again, without a gap
---@field flat? boolean without a place: music, menus
---@field paused? boolean waits for play
---@field group? string whose loudness it shares

---Makes something that sounds, and starts it.
---@param options corsac.audio.newSource.options the source
---@return corsac.Source source
function corsac.audio.newSource(options) end

---@class corsac.audio.setListener.options
---@field entity? corsac.Entity who hears; looks along its -Z
---@field position? number[] a fixed place instead, m
---@field rotation? number[]|corsac.AxisAngle at a fixed place
---@field velocity? number[] at a fixed place, m/s

---Who hears; without it, the camera does.
---@param options corsac.audio.setListener.options the listener
function corsac.audio.setListener(options) end

---Loudness of all sources of a group.
---@param name string "effects", "music", your own
---@param gain number factor of amplitude
function corsac.audio.setGroup(name, gain) end

---Loudness of a group.
---@param name string of the group
---@return number gain
function corsac.audio.getGroup(name) end
