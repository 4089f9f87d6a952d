(** The machine: the small-step semantics of the static core of the language, and the distribution over scenes that it gives a program.

    The paper, appendix "Semantics of Scenic": a configuration ⟨s, σ, π, O⟩ is rewritten by the rules of the figures "Semantics of
    expressions" and "Semantics of statements", "and we write →^p for a rewrite rule that fires with probability p"; "the product of the
    probabilities of all rewrite rules yields a probability for the trace"; "if we discard all traces which do not terminate (due to
    violating a requirement), then normalizing the probabilities of the remaining traces yields a distribution over [...] scenes".

    [step], [done], [stuck_at] and [fault] are the rules as inductive relations, with the names of the catalogue (`scenic-ref rules`), made
    longer where one rule is several constructors; those called Premise only fetch the premises, from left to right. [machine] is the same
    as a function, as [step] of semantics/step.py, with its frames; [runs] finds all runs of a program. Proved:

    - [the_function_says_what_the_rules_say], [the_rules_say_what_the_function_says]: the two agree;
    - [two_steps_with_one_answer_lead_to_one_configuration], [the_answers_to_draws_determine_the_run];
    - [every_configuration_steps_asks_is_done_is_stuck_or_is_a_named_error]: exactly one of these;
    - [every_program_ends], [the_runs_found_are_the_runs], [no_run_is_found_twice], [the_masses_of_all_runs_add_up_to_1];
    - [the_law_of_scenes_is_that_of_done_runs_divided_by_their_mass], [a_stuck_run_contributes_nothing],
      [the_law_has_mass_1_if_some_run_is_done], [errors_are_kept_apart].

    The core: numbers (rational), truth values, vectors, objects; variables; arithmetic, comparisons, `and`, `or`, `not`, `@`, properties;
    distributions over finitely many weighted expressions; object definitions with the specifiers `with P E` and `at V`, for Object and
    classes right below it, whose default value expressions may read `self` (Algorithm 1 is [Resolution.resolve]); assignments, `param`,
    `require`, `require[p]`, `mutate ... by`; both termination steps; both readings of `require-time`. An object definition carries the
    default value expressions of its class with it, so that no class can create objects of its own kind without end.

    Parameters of the machine are what the core cannot compute with rational numbers: the noise of Step 1, a finite distribution for each
    standard deviation, which stands for Normal(0, s); when two bounding boxes intersect; what an object can see; and 5 degrees, the default
    of headingStdDev. The workspace is the whole plane, so that Step 2 has no premise boundingBox(O) ⊆ workspace. A product of two vectors, and
    what else Python may say of `*` and `/` where one operand is no number, is [Beyond_the_core]. *)
From Coq Require Import QArith List Bool Arith Lia Qabs Lqa Wf_nat FinFun Permutation.
From ScenicRef Require scenes.Resolution.
From ScenicRef Require Import kernel.Distribution.
Import ListNotations.
Open Scope nat_scope.

(** * Syntax *)

Definition variable := nat.
Definition property := nat.

(** The variable `ego`, and the properties of Object that have a meaning of their own. *)
Definition ego : variable := 0.
Definition position : property := 0.
Definition heading : property := 1.
Definition width : property := 2.
Definition extent : property := 3. (* along the y axis: `length` *)
Definition viewDistance : property := 4.
Definition mutationScale : property := 5.
Definition positionStdDev : property := 6.
Definition headingStdDev : property := 7.
Definition allowCollisions : property := 8.
Definition requireVisible : property := 9.

Inductive value := Number (q : Q) | Truth (b : bool) | Vector (x y : Q) | Instance (n : nat).

Inductive operator := Plus | Minus | Times | Divided.
Inductive comparison := Equal | Unequal | Less | At_most.
Inductive binary := Arithmetic (o : operator) | Compare (o : comparison) | VectorOf.
Inductive attribute := Property (p : property) | Coordinate_x | Coordinate_y.
Inductive specifier := With (p : property) | At.

Inductive expr :=
| Constant (v : value)
| Name (x : variable)
| Self (p : property) (* self.p *)
| Attribute (e : expr) (a : attribute)
| Negative (e : expr)
| Not (e : expr)
| Binary (o : binary) (e1 e2 : expr)
| Boolean (conjunction : bool) (e1 e2 : expr)
| Discrete (params : list (expr * Q))
| Object (own : list (property * expr)) (specifiers : list (specifier * expr)). (* of a class with these default value expressions *)

Inductive statement :=
| Assign (x : variable) (e : expr)
| Param (x : variable) (e : expr)
| Require (line : nat) (b : expr)
| SoftRequire (line : nat) (p : Q) (b : expr)
| Mutate (objects : list expr) (scale : expr) (* all objects, if there are none in the list *)
| Expression (e : expr).

(** * Configurations *)

Definition bindings := list (nat * value).

Fixpoint lookup (x : nat) (s : bindings) : option value :=
  match s with [] => None | (y, v) :: rest => if x =? y then Some v else lookup x rest end.
Fixpoint put (x : nat) (v : value) (s : bindings) : bindings :=
  match s with [] => [(x, v)] | (y, w) :: rest => if x =? y then (y, v) :: rest else (y, w) :: put x v rest end.

(** σ, π and O; `self`, the properties so far of the object that is being made; the requirements that wait for the end, each with the
    σ and O of its statement (`Captured` in semantics/machine/config.py). *)
Record captured := Captured { its_line : nat; its_condition : expr; its_sigma : bindings; its_objects : list bindings }.
Record state := State {
  sigma : bindings;
  params : bindings;
  objects : list bindings;
  self : option bindings;
  late : list captured
}.

Definition with_sigma t s := State t (params s) (objects s) (self s) (late s).
Definition with_params t s := State (sigma s) t (objects s) (self s) (late s).
Definition with_objects t s := State (sigma s) (params s) t (self s) (late s).
Definition with_self t s := State (sigma s) (params s) (objects s) t (late s).
Definition with_late t s := State (sigma s) (params s) (objects s) (self s) t.

(** ((s_1, p_1), ..., (s_n, p_n)): each specifier with its value, if it is known. *)
Inductive specification := By_with (p : property) (v : value) | By_at (v : value) | By_default (p : property) (e : expr).

(** What is left of an object definition, and the `self` around it. *)
Record construction := Construction { order : list specification; around : option bindings }.

(** The frames of the context of an expression. *)
Inductive frame :=
| Attribute_of (a : attribute)
| Negative_of
| Not_of
| Left_of (o : binary) (e2 : expr)
| Right_of (o : binary) (v1 : value)
| Boolean_of (conjunction : bool) (e2 : expr)
| Weighing (before : list (value * Q)) (w : Q) (after : list (expr * Q))
| Specifying (own : list (property * expr)) (before : list (specifier * value)) (s : specifier) (after : list (specifier * expr))
| Defaulting (p : property) (c : construction).

(** The statement around it, and what comes after the statement: others, or, at the end, the requirements that are left of those that
    waited, and the state to go back to. *)
Inductive context :=
| Assigning (x : variable)
| Setting (x : variable)
| Requiring (line : nat)
| Targeting (before : list value) (after : list expr) (scale : expr)
| Scaling (targets : list value)
| Discarding.
Inductive continuation := Then (rest : list statement) | Then_late (rest : list captured) (ending : state).
Record place := Place { frames : list frame; statement_of : context; next : continuation }.
Definition inside f k := Place (f :: frames k) (statement_of k) (next k).

(** A condition of the program, or one of the default requirements of Step 2. *)
Inductive requirement := Condition (line : nat) | Collision (i j : nat) | Visibility (i : nat).

Inductive config :=
| Evaluate (e : expr) (k : place) (s : state)
| Sample (before : list (value * Q)) (after : list (expr * Q)) (k : place) (s : state)
| Specify (own : list (property * expr)) (before : list (specifier * value)) (after : list (specifier * expr)) (k : place) (s : state)
| Construct (c : construction) (k : place) (s : state)
| Have (v : value) (k : place) (s : state)
| Execute (program : list statement) (s : state) (* the empty one is pass *)
| Apply_mutations (i : nat) (drawn : list Q) (s : state)
| Check_late (rest : list captured) (s : state)
| Check (premises : list requirement) (s : state).

(** A scene is (π, O), with the number of ego. *)
Record scene := Scene { its_params : bindings; its_ego : option value; its_content : list bindings }.

(** What can be wrong with a program. *)
Inductive error :=
| Not_defined (x : variable)
| No_self
| No_attribute
| Type_error
| Division_by_zero
| No_scalars
| Bad_parameters
| No_vector
| Ill_formed (e : Resolution.error)
| Bad_property (p : property)
| Ego_is_no_object
| No_boolean (line : nat)
| Bad_probability (line : nat)
| Bad_scale
| Not_mutable
| No_ego
| Beyond_the_core.

Definition answer (A : Type) : Type := (A + error)%type.

(** * What the operators compute *)

Definition number_of (v : value) : option Q :=
  match v with Number q => Some q | Truth b => Some (if b then 1 else 0)%Q | _ => None end.

Definition truth_of (v : value) : bool :=
  match v with Number q => negb (Qeq_bool q 0) | Truth b => b | _ => true end.

Definition read (p : property) (o : bindings) : Q := match lookup p o with Some (Number q) => q | _ => 0%Q end.
Definition holds (p : property) (o : bindings) : bool := match lookup p o with Some (Truth b) => b | _ => false end.

(** An object where a vector (or a heading) is meant. *)
Definition as_its (p : property) (O : list bindings) (v : value) : value :=
  match v with
  | Instance n => match nth_error O n with Some o => match lookup p o with Some w => w | None => v end | None => v end
  | _ => v
  end.

Definition arithmetic (o : operator) (v1 v2 : value) : answer value :=
  match number_of v1, number_of v2 with
  | Some a, Some b =>
      match o with
      | Plus => inl (Number (Qred (a + b)))
      | Minus => inl (Number (Qred (a - b)))
      | Times => inl (Number (Qred (a * b)))
      | Divided => if Qeq_bool b 0 then inr Division_by_zero else inl (Number (Qred (a / b)))
      end
  | _, _ =>
      match o, v1, v2 with
      | Plus, Vector x y, Vector x' y' => inl (Vector (Qred (x + x')) (Qred (y + y')))
      | Minus, Vector x y, Vector x' y' => inl (Vector (Qred (x - x')) (Qred (y - y')))
      | Plus, _, _ | Minus, _, _ => inr Type_error
      | Times, Vector x y, Number q | Times, Number q, Vector x y => inl (Vector (Qred (x * q)) (Qred (y * q)))
      | Divided, Vector x y, Number q => if Qeq_bool q 0 then inr Division_by_zero else inl (Vector (Qred (x / q)) (Qred (y / q)))
      | _, _, _ => inr Beyond_the_core
      end
  end.

Definition negative (v : value) : answer value :=
  match number_of v, v with
  | Some q, _ => inl (Number (Qred (- q)))
  | None, Vector x y => inl (Vector (Qred (- x)) (Qred (- y)))
  | None, _ => inr Type_error
  end.

Definition equal (v1 v2 : value) : bool :=
  match number_of v1, number_of v2, v1, v2 with
  | Some a, Some b, _, _ => Qeq_bool a b
  | _, _, Vector x y, Vector x' y' => Qeq_bool x x' && Qeq_bool y y'
  | _, _, Instance n, Instance m => n =? m
  | _, _, _, _ => false
  end.

Definition compare (o : comparison) (v1 v2 : value) : answer value :=
  match o, number_of v1, number_of v2 with
  | Equal, _, _ => inl (Truth (equal v1 v2))
  | Unequal, _, _ => inl (Truth (negb (equal v1 v2)))
  | Less, Some a, Some b => inl (Truth (negb (Qle_bool b a)))
  | At_most, Some a, Some b => inl (Truth (Qle_bool a b))
  | _, _, _ => inr Type_error
  end.

Definition vector_of (v1 v2 : value) : answer value :=
  match v1, v2 with Number x, Number y => inl (Vector x y) | _, _ => inr No_scalars end.

Definition attribute_of (O : list bindings) (v : value) (a : attribute) : answer value :=
  match v, a with
  | Vector x _, Coordinate_x => inl (Number x)
  | Vector _ y, Coordinate_y => inl (Number y)
  | Instance n, Property p =>
      match nth_error O n with
      | Some o => match lookup p o with Some w => inl w | None => inr No_attribute end
      | None => inr No_attribute
      end
  | _, _ => inr No_attribute
  end.

Definition of_self (p : property) (s : state) : answer value :=
  match self s with
  | None => inr No_self
  | Some o => match lookup p o with Some v => inl v | None => inr No_attribute end
  end.

(** The first premise of an expression, with the frame around it. *)
Definition focus (e : expr) : option (expr * frame) :=
  match e with
  | Attribute e a => Some (e, Attribute_of a)
  | Negative e => Some (e, Negative_of)
  | Not e => Some (e, Not_of)
  | Binary o e1 e2 => Some (e1, Left_of o e2)
  | Boolean c e1 e2 => Some (e1, Boolean_of c e2)
  | _ => None
  end.

(** * Distributions *)

Definition positive {A} (d : dist A) : dist A := filter (fun aw => negb (Qle_bool (snd aw) 0)) d.

(** P_θ over the values that have a weight (`support` of `Discrete` and `Uniform`): none, if a weight is negative or all are 0. *)
Definition base_dist (theta : list (value * Q)) : option (dist value) :=
  if forallb (fun aw => Qle_bool 0 (snd aw)) theta
  then match positive theta with [] => None | d => Some (normalised d) end
  else None.

(** The coin of `require[p] B`. *)
Definition throw (p : Q) : option (dist value) :=
  if Qle_bool 0 p && Qle_bool p 1 then Some (positive [(Truth true, p); (Truth false, 1 - p)%Q]) else None.

(** * Objects *)

(** The properties that `self` is asked for in a default value expression. *)
Fixpoint reads (e : expr) : list property :=
  match e with
  | Constant _ | Name _ => []
  | Self p => [p]
  | Attribute e _ | Negative e | Not e => reads e
  | Binary _ e1 e2 | Boolean _ e1 e2 => reads e1 ++ reads e2
  | Discrete params => flat_map (fun ew => reads (fst ew)) params
  | Object _ specifiers => flat_map (fun se => reads (snd se)) specifiers
  end.

Fixpoint numbered {A B C} (make : nat -> A -> B -> C) (n : nat) (l : list (A * B)) : list C :=
  match l with [] => [] | (a, b) :: rest => make n a b :: numbered make (S n) rest end.

Definition determined (s : specifier) : property := match s with With p => p | At => position end.

Section Machine.
Variable five_degrees : Q.
Variable noise : Q -> dist Q.
Variable boxes_intersect : bindings -> bindings -> bool.
Variable can_see : bindings -> bindings -> bool.
Variable at_the_end : bool. (* the reading `require-time=end` *)

(** Table "Properties of the built-in classes", as far as the core goes. *)
Definition built_in : list (property * expr) :=
  map (fun pv => (fst pv, Constant (snd pv)))
    [(position, Vector 0 0); (viewDistance, Number 50); (mutationScale, Number 0); (positionStdDev, Number 1);
     (heading, Number 0); (headingStdDev, Number five_degrees); (width, Number 1); (extent, Number 1);
     (allowCollisions, Truth false); (requireVisible, Truth true)].

(** resolveSpecifiers(class, specifiers). A specifier is named by its place, a default value expression by its number. *)
Definition resolved (own : list (property * expr)) (specifiers : list specifier) :=
  let default n p e := (p, Resolution.Expression n (reads e)) in
  Resolution.resolve
    [numbered default 0 own; numbered default (length own) built_in]
    (numbered (fun n s (_ : unit) => Resolution.Specifier n [determined s] [] []) 0 (map (fun s => (s, tt)) specifiers)).

Definition expressions (own : list (property * expr)) : list expr := map snd own ++ map snd built_in.

(** The order with the values of the specifiers, which are evaluated already (the reading `specifier-arguments`). *)
Definition ordered own (arguments : list (specifier * value)) (order : list (Resolution.specification * list Resolution.property)) :=
  flat_map (fun x =>
    match fst x with
    | Resolution.Written s =>
        match nth_error arguments (Resolution.name s) with
        | Some (With p, v) => [By_with p v]
        | Some (At, v) => [By_at v]
        | None => []
        end
    | Resolution.Default p e => match nth_error (expressions own) (Resolution.text e) with Some e => [By_default p e] | None => [] end
    end) order.

(** `at V` needs a vector. *)
Definition is_vector (O : list bindings) (v : value) : bool := match as_its position O v with Vector _ _ => true | _ => false end.
Definition vectors_where_meant (O : list bindings) (arguments : list (specifier * value)) : bool :=
  forallb (fun sv => match fst sv with At => is_vector O (snd sv) | With _ => true end) arguments.

(** A value as that of a property (`checked_property` in semantics/machine/built_in_properties.py). *)
Definition checked (O : list bindings) (p : property) (v : value) : answer value :=
  if p =? position then match as_its position O v with Vector x y => inl (Vector x y) | _ => inr (Bad_property p) end
  else if p =? heading then match as_its heading O v with Number q => inl (Number q) | _ => inr (Bad_property p) end
  else if (p =? allowCollisions) || (p =? requireVisible) then match v with Truth _ => inl v | _ => inr (Bad_property p) end
  else if p <? allowCollisions
  then match v with Number q => if Qle_bool 0 q then inl v else inr (Bad_property p) | _ => inr (Bad_property p) end
  else inl v.

(** The properties that `self` has so far. *)
Definition so_far (s : state) : bindings := match self s with Some o => o | None => [] end.

(** self.p / v, and the rest of the specifiers. *)
Definition assigned p v (rest : list specification) (outer : option bindings) k s : config :=
  Construct (Construction rest outer) k (with_self (Some (put p v (so_far s))) s).

(** * Statements *)

Definition after (c : continuation) (s : state) : config :=
  match c with
  | Then rest => Execute rest s
  | Then_late rest e => Check_late rest (with_sigma (sigma e) (with_objects (objects e ++ skipn (length (objects e)) (objects s)) s))
  end.

Definition assignable (x : variable) (v : value) : bool :=
  match v with Instance _ => true | _ => negb (x =? ego) end.

(** The premises of `mutate`: its objects, then the scale. *)
Definition targets (before : list value) (rest : list expr) (scale : expr) (c : continuation) (s : state) : config :=
  match rest with
  | [] => Evaluate scale (Place [] (Scaling before) c) s
  | e :: rest => Evaluate e (Place [] (Targeting before rest scale) c) s
  end.

Fixpoint update {A} (n : nat) (f : A -> A) (l : list A) : list A :=
  match l, n with [], _ => [] | a :: l, 0 => f a :: l | a :: l, S n => a :: update n f l end.

(** O[o_i.mutationScale / s] for the objects o_i; None, if one is no object. *)
Fixpoint scaled (vs : list value) (scale : value) (O : list bindings) : option (list bindings) :=
  match vs with
  | [] => Some O
  | Instance n :: vs => if n <? length O then scaled vs scale (update n (put mutationScale scale) O) else None
  | _ :: _ => None
  end.

Definition mutated_objects (vs : list value) (scale : value) (O : list bindings) : answer (list bindings) :=
  match scale with
  | Number q =>
      if Qle_bool 0 q
      then
        match scaled (match vs with [] => map Instance (seq 0 (length O)) | _ => vs end) scale O with
        | Some changed => inl changed
        | None => inr Not_mutable
        end
      else inr Bad_scale
  | _ => inr Bad_scale
  end.

(** * Termination *)

(** S_i · ps_i for the two coordinates, S_i · hs_i for the heading. *)
Definition deviation (o : bindings) (component : nat) : Q :=
  Qred (read mutationScale o * read (if component <? 2 then positionStdDev else headingStdDev) o).
Definition is_mutated (o : bindings) : bool := negb (Qeq_bool (read mutationScale o) 0).
Definition is_point_mass (s : Q) : bool := Qle_bool s 0.

(** O[o_i.position / pos_i][o_i.heading / head_i]. *)
Definition moved (drawn : list Q) (o : bindings) : bindings :=
  match as_its position [] (match lookup position o with Some v => v | None => Vector 0 0 end) with
  | Vector x y => put position (Vector (Qred (x + nth 0 drawn 0%Q)) (Qred (y + nth 1 drawn 0%Q)))
      (put heading (Number (Qred (read heading o + nth 2 drawn 0%Q))) o)
  | _ => o
  end.

(** The state in which a requirement is checked that waited: that of its statement, with the noise (the reading `requirement-capture`). *)
Definition with_noise_of (now captured : bindings) : bindings :=
  if is_mutated now
  then match lookup position now, lookup heading now with Some v, Some h => put position v (put heading h captured) | _, _ => captured end
  else captured.
Fixpoint captured_objects (now captured : list bindings) : list bindings :=
  match now, captured with
  | [], _ => []
  | _, [] => now
  | o :: now, c :: captured => with_noise_of o c :: captured_objects now captured
  end.
Definition as_captured (c : captured) (s : state) : state :=
  with_sigma (its_sigma c) (with_objects (captured_objects (objects s) (its_objects c)) s).

(** The premises of Step 2: ∀ i ≠ j that may not collide, then ∀ i that must be visible. *)
Definition which (holds : bindings -> bool) (O : list bindings) : list nat :=
  map fst (filter (fun io => holds (snd io)) (combine (seq 0 (length O)) O)).
Fixpoint pairs (before rest : list nat) : list requirement :=
  match rest with [] => [] | j :: rest => map (fun i => Collision i j) before ++ pairs (before ++ [j]) rest end.
Definition default_requirements (O : list bindings) : list requirement :=
  pairs [] (which (fun o => negb (holds allowCollisions o)) O) ++ map Visibility (which (holds requireVisible) O).

Definition object (O : list bindings) (n : nat) : bindings := nth n O [].
Definition is_met (r : requirement) (s : state) : bool :=
  match r with
  | Condition _ => true
  | Collision i j => negb (boxes_intersect (object (objects s) i) (object (objects s) j))
  | Visibility i =>
      match lookup ego (sigma s) with Some (Instance n) => can_see (object (objects s) n) (object (objects s) i) | _ => true end
  end.

(** * The machine as a function *)

Inductive outcome :=
| Next (c : config)
| Draw (d : dist value) (resume : value -> config)
| Done (found : scene)
| Stuck (r : requirement)
| Fault (e : error).

(** A rule that fires if its premise has a value. *)
Definition given_value {A} (a : answer A) (c : A -> config) : outcome := match a with inl a => Next (c a) | inr e => Fault e end.

Definition machine (c : config) : outcome :=
  match c with
  | Evaluate e k s =>
      match e with
      | Constant v => Next (Have v k s)
      | Name x => match lookup x (sigma s) with Some v => Next (Have v k s) | None => Fault (Not_defined x) end
      | Self p => given_value (of_self p s) (fun v => Have v k s)
      | Discrete params => Next (Sample [] params k s)
      | Object own specifiers => Next (Specify own [] specifiers k s)
      | Attribute e a => Next (Evaluate e (inside (Attribute_of a) k) s)
      | Negative e => Next (Evaluate e (inside Negative_of k) s)
      | Not e => Next (Evaluate e (inside Not_of k) s)
      | Binary o e1 e2 => Next (Evaluate e1 (inside (Left_of o e2) k) s)
      | Boolean b e1 e2 => Next (Evaluate e1 (inside (Boolean_of b e2) k) s)
      end
  | Sample before ((e, w) :: rest) k s => Next (Evaluate e (inside (Weighing before w rest) k) s)
  | Sample theta [] k s => match base_dist theta with Some d => Draw d (fun v => Have v k s) | None => Fault Bad_parameters end
  | Specify own before ((x, e) :: rest) k s => Next (Evaluate e (inside (Specifying own before x rest) k) s)
  | Specify own arguments [] k s =>
      if vectors_where_meant (objects s) arguments
      then match resolved own (map fst arguments) with
           | Resolution.Resolved order => Next (Construct (Construction (ordered own arguments order) (self s)) k (with_self (Some []) s))
           | Resolution.Failed e => Fault (Ill_formed e)
           end
      else Fault No_vector
  | Construct (Construction order outer) k s =>
      match order with
      | [] =>
          Next (Have (Instance (length (objects s))) k (with_self outer (with_objects (objects s ++ [so_far s]) s)))
      | By_with p v :: rest => given_value (checked (objects s) p v) (fun v => assigned p v rest outer k s)
      | By_at v :: rest => given_value (checked (objects s) position v) (fun v => assigned position v rest outer k s)
      | By_default p e :: rest => Next (Evaluate e (inside (Defaulting p (Construction rest outer)) k) s)
      end
  | Have v (Place (f :: fs) c n) s =>
      let k := Place fs c n in
      match f with
      | Attribute_of a => given_value (attribute_of (objects s) v a) (fun v => Have v k s)
      | Negative_of => given_value (negative v) (fun v => Have v k s)
      | Not_of => Next (Have (Truth (negb (truth_of v))) k s)
      | Left_of o e2 => Next (Evaluate e2 (inside (Right_of o v) k) s)
      | Right_of (Arithmetic o) v1 =>
          given_value (arithmetic o (as_its position (objects s) v1) (as_its position (objects s) v)) (fun v => Have v k s)
      | Right_of (Compare o) v1 => given_value (compare o v1 v) (fun v => Have v k s)
      | Right_of VectorOf v1 => given_value (vector_of v1 v) (fun v => Have v k s)
      | Boolean_of conjunction e2 => if Bool.eqb (truth_of v) conjunction then Next (Evaluate e2 k s) else Next (Have v k s)
      | Weighing before w rest => Next (Sample (before ++ [(v, w)]) rest k s)
      | Specifying own before x rest => Next (Specify own (before ++ [(x, v)]) rest k s)
      | Defaulting p (Construction rest outer) => given_value (checked (objects s) p v) (fun v => assigned p v rest outer k s)
      end
  | Have v (Place [] c n) s =>
      match c with
      | Assigning x => if assignable x v then Next (after n (with_sigma (put x v (sigma s)) s)) else Fault Ego_is_no_object
      | Setting x => Next (after n (with_params (put x v (params s)) s))
      | Requiring line =>
          match v with
          | Truth true => Next (after n s)
          | Truth false => Stuck (Condition line)
          | _ => Fault (No_boolean line)
          end
      | Targeting before rest scale => Next (targets (before ++ [v]) rest scale n s)
      | Scaling vs => given_value (mutated_objects vs v (objects s)) (fun changed => after n (with_objects changed s))
      | Discarding => Next (after n s)
      end
  | Execute (Assign x e :: rest) s => Next (Evaluate e (Place [] (Assigning x) (Then rest)) s)
  | Execute (Param x e :: rest) s => Next (Evaluate e (Place [] (Setting x) (Then rest)) s)
  | Execute (Require line b :: rest) s =>
      if at_the_end
      then Next (Execute rest (with_late (late s ++ [Captured line b (sigma s) (objects s)]) s))
      else Next (Evaluate b (Place [] (Requiring line) (Then rest)) s)
  | Execute (SoftRequire line p b :: rest) s =>
      match throw p with
      | Some d => Draw d (fun v => if truth_of v then Execute (Require line b :: rest) s else Execute rest s)
      | None => Fault (Bad_probability line)
      end
  | Execute (Mutate es scale :: rest) s => Next (targets [] es scale (Then rest) s)
  | Execute (Expression e :: rest) s => Next (Evaluate e (Place [] Discarding (Then rest)) s)
  | Execute [] s => match lookup ego (sigma s) with Some _ => Next (Apply_mutations 0 [] s) | None => Fault No_ego end
  | Apply_mutations i drawn s =>
      match nth_error (objects s) i with
      | None => Next (Check_late (late s) (with_late [] s))
      | Some o =>
          if is_mutated o
          then if length drawn <? 3
               then if is_point_mass (deviation o (length drawn))
                    then Next (Apply_mutations i (drawn ++ [0%Q]) s)
                    else Draw (map (fun xw => (Number (fst xw), snd xw)) (noise (deviation o (length drawn))))
                           (fun v => Apply_mutations i (drawn ++ [match number_of v with Some q => q | None => 0%Q end]) s)
               else Next (Apply_mutations (S i) [] (with_objects (update i (moved drawn) (objects s)) s))
          else Next (Apply_mutations (S i) [] s)
      end
  | Check_late (c :: rest) s => Next (Evaluate (its_condition c) (Place [] (Requiring (its_line c)) (Then_late rest s)) (as_captured c s))
  | Check_late [] s => Next (Check (default_requirements (objects s)) s)
  | Check (r :: rest) s => if is_met r s then Next (Check rest s) else Stuck r
  | Check [] s => Done (Scene (params s) (lookup ego (sigma s)) (objects s))
  end.

(** * The machine as rules *)

(** What a draw was answered: the place of the value among those of the distribution, the value, and its probability. *)
Definition answered := (nat * value * Q)%type.

Reserved Notation "c ⟶ c'" (at level 70, no associativity).
Reserved Notation "c ⟶[ a ] c'" (at level 70, no associativity).

(** [step c None c'] is c → c', which fires with probability 1; [step c (Some (i, v, p)) c'] is c →^p c'. *)
Inductive step : config -> option answered -> config -> Prop :=

(* Bookkeeping between the rules: the premises come from left to right. *)
| Premise e e1 f k s : focus e = Some (e1, f) -> Evaluate e k s ⟶ Evaluate e1 (inside f k) s
| Premise_right o e2 v fs c n s :
    Have v (Place (Left_of o e2 :: fs) c n) s ⟶ Evaluate e2 (Place (Right_of o v :: fs) c n) s
| Premise_params params k s : Evaluate (Discrete params) k s ⟶ Sample [] params k s
| Premise_param before e w rest k s : Sample before ((e, w) :: rest) k s ⟶ Evaluate e (inside (Weighing before w rest) k) s
| Premise_param_known before w rest v fs c n s :
    Have v (Place (Weighing before w rest :: fs) c n) s ⟶ Sample (before ++ [(v, w)]) rest (Place fs c n) s
| Premise_specifiers own specifiers k s : Evaluate (Object own specifiers) k s ⟶ Specify own [] specifiers k s
| Premise_specifier own before x e rest k s :
    Specify own before ((x, e) :: rest) k s ⟶ Evaluate e (inside (Specifying own before x rest) k) s
| Premise_specifier_known own before x rest v fs c n s :
    Have v (Place (Specifying own before x rest :: fs) c n) s ⟶ Specify own (before ++ [(x, v)]) rest (Place fs c n) s
| Premise_default p e rest outer k s :
    Construct (Construction (By_default p e :: rest) outer) k s ⟶ Evaluate e (inside (Defaulting p (Construction rest outer)) k) s

(* Figure "Semantics of expressions", and the standard rules. *)
| E_Constant v k s : Evaluate (Constant v) k s ⟶ Have v k s
| E_Variable x v k s : lookup x (sigma s) = Some v -> Evaluate (Name x) k s ⟶ Have v k s
| E_Attribute_Self p v k s : of_self p s = inl v -> Evaluate (Self p) k s ⟶ Have v k s
| E_Attribute a v w fs c n s :
    attribute_of (objects s) v a = inl w -> Have v (Place (Attribute_of a :: fs) c n) s ⟶ Have w (Place fs c n) s
| E_Arithmetic o v1 v2 w fs c n s :
    arithmetic o (as_its position (objects s) v1) (as_its position (objects s) v2) = inl w ->
    Have v2 (Place (Right_of (Arithmetic o) v1 :: fs) c n) s ⟶ Have w (Place fs c n) s
| E_Arithmetic_Unary v w fs c n s : negative v = inl w -> Have v (Place (Negative_of :: fs) c n) s ⟶ Have w (Place fs c n) s
| E_Not v fs c n s : Have v (Place (Not_of :: fs) c n) s ⟶ Have (Truth (negb (truth_of v))) (Place fs c n) s
| E_Compare o v1 v2 w fs c n s :
    compare o v1 v2 = inl w -> Have v2 (Place (Right_of (Compare o) v1 :: fs) c n) s ⟶ Have w (Place fs c n) s
| E_Boolean_Open conjunction e2 v fs c n s :
    truth_of v = conjunction -> Have v (Place (Boolean_of conjunction e2 :: fs) c n) s ⟶ Evaluate e2 (Place fs c n) s
| E_Boolean_Decided conjunction e2 v fs c n s :
    truth_of v <> conjunction -> Have v (Place (Boolean_of conjunction e2 :: fs) c n) s ⟶ Have v (Place fs c n) s
| O_VectorOf v1 v2 w fs c n s :
    vector_of v1 v2 = inl w -> Have v2 (Place (Right_of VectorOf v1 :: fs) c n) s ⟶ Have w (Place fs c n) s
| E_Distributions theta d i v p k s :
    base_dist theta = Some d -> nth_error d i = Some (v, p) -> Sample theta [] k s ⟶[(i, v, p)] Have v k s
| R_ResolveSpecifiers own arguments order k s :
    vectors_where_meant (objects s) arguments = true -> resolved own (map fst arguments) = Resolution.Resolved order ->
    Specify own arguments [] k s ⟶ Construct (Construction (ordered own arguments order) (self s)) k (with_self (Some []) s)
| P_With p v w rest outer k s :
    checked (objects s) p v = inl w -> Construct (Construction (By_with p v :: rest) outer) k s ⟶ assigned p w rest outer k s
| P_At v w rest outer k s :
    checked (objects s) position v = inl w -> Construct (Construction (By_at v :: rest) outer) k s ⟶ assigned position w rest outer k s
| P_Default p v w rest outer fs c n s :
    checked (objects s) p v = inl w ->
    Have v (Place (Defaulting p (Construction rest outer) :: fs) c n) s ⟶ assigned p w rest outer (Place fs c n) s
| E_ObjectDefinition outer inst k s :
    inst = so_far s ->
    Construct (Construction [] outer) k s
    ⟶ Have (Instance (length (objects s))) k (with_self outer (with_objects (objects s ++ [inst]) s))

(* Figure "Semantics of statements". *)
| Premise_assignment x e rest s : Execute (Assign x e :: rest) s ⟶ Evaluate e (Place [] (Assigning x) (Then rest)) s
| S_Assignment x v n s : assignable x v = true -> Have v (Place [] (Assigning x) n) s ⟶ after n (with_sigma (put x v (sigma s)) s)
| Premise_parameter x e rest s : Execute (Param x e :: rest) s ⟶ Evaluate e (Place [] (Setting x) (Then rest)) s
| S_Param x v n s : Have v (Place [] (Setting x) n) s ⟶ after n (with_params (put x v (params s)) s)
| Premise_expression e rest s : Execute (Expression e :: rest) s ⟶ Evaluate e (Place [] Discarding (Then rest)) s
| Premise_expression_known v n s : Have v (Place [] Discarding n) s ⟶ after n s
| Premise_condition line b rest s :
    at_the_end = false -> Execute (Require line b :: rest) s ⟶ Evaluate b (Place [] (Requiring line) (Then rest)) s
| S_Require line n s : Have (Truth true) (Place [] (Requiring line) n) s ⟶ after n s
| S_Require_Capture line b rest s :
    at_the_end = true ->
    Execute (Require line b :: rest) s ⟶ Execute rest (with_late (late s ++ [Captured line b (sigma s) (objects s)]) s)
| S_SoftReq_Check line p b rest d i q s :
    throw p = Some d -> nth_error d i = Some (Truth true, q) ->
    Execute (SoftRequire line p b :: rest) s ⟶[(i, Truth true, q)] Execute (Require line b :: rest) s
| S_SoftReq_Skip line p b rest d i q s :
    throw p = Some d -> nth_error d i = Some (Truth false, q) ->
    Execute (SoftRequire line p b :: rest) s ⟶[(i, Truth false, q)] Execute rest s
| Premise_mutate es scale rest s : Execute (Mutate es scale :: rest) s ⟶ targets [] es scale (Then rest) s
| Premise_target before rest scale v n s :
    Have v (Place [] (Targeting before rest scale) n) s ⟶ targets (before ++ [v]) rest scale n s
| S_Mutate vs scale O' n s :
    mutated_objects vs scale (objects s) = inl O' -> Have scale (Place [] (Scaling vs) n) s ⟶ after n (with_objects O' s)

(* Termination, Step 1, object by object and component by component. *)
| Premise_noise v s : lookup ego (sigma s) = Some v -> Execute [] s ⟶ Apply_mutations 0 [] s
| T_Mutate_Unscaled i o drawn s :
    nth_error (objects s) i = Some o -> is_mutated o = false -> Apply_mutations i drawn s ⟶ Apply_mutations (S i) [] s
| T_Mutate_PointMass i o drawn s :
    nth_error (objects s) i = Some o -> is_mutated o = true -> length drawn < 3 -> is_point_mass (deviation o (length drawn)) = true ->
    Apply_mutations i drawn s ⟶ Apply_mutations i (drawn ++ [0%Q]) s
| T_Mutate_Draw i o drawn place q p s :
    nth_error (objects s) i = Some o -> is_mutated o = true -> length drawn < 3 -> is_point_mass (deviation o (length drawn)) = false ->
    nth_error (noise (deviation o (length drawn))) place = Some (q, p) ->
    Apply_mutations i drawn s ⟶[(place, Number q, p)] Apply_mutations i (drawn ++ [q]) s
| T_Mutate_Moved i o drawn s :
    nth_error (objects s) i = Some o -> is_mutated o = true -> 3 <= length drawn ->
    Apply_mutations i drawn s ⟶ Apply_mutations (S i) [] (with_objects (update i (moved drawn) (objects s)) s)
| T_Mutate i drawn s : nth_error (objects s) i = None -> Apply_mutations i drawn s ⟶ Check_late (late s) (with_late [] s)

(* The requirements that waited, and the premises of Step 2. *)
| Premise_late c rest s :
    Check_late (c :: rest) s ⟶ Evaluate (its_condition c) (Place [] (Requiring (its_line c)) (Then_late rest s)) (as_captured c s)
| Premise_check s : Check_late [] s ⟶ Check (default_requirements (objects s)) s
| T_Check_Premise r rest s : is_met r s = true -> Check (r :: rest) s ⟶ Check rest s
where "c ⟶ c'" := (step c None c') and "c ⟶[ a ] c'" := (step c (Some a) c').

(** ⟨Done, σ, π, O⟩ → (π, O). *)
Inductive done : config -> scene -> Prop :=
| T_Check s : done (Check [] s) (Scene (params s) (lookup ego (sigma s)) (objects s)).

(** "If the condition is not satisfied, no rules apply and the program fails to terminate normally." *)
Inductive stuck_at : config -> requirement -> Prop :=
| Violated line n s : stuck_at (Have (Truth false) (Place [] (Requiring line) n) s) (Condition line)
| Violated_default r rest s : is_met r s = false -> stuck_at (Check (r :: rest) s) r.

(** Where a premise cannot hold whatever is drawn. *)
Inductive fault : config -> error -> Prop :=
| Wrong_variable x k s : lookup x (sigma s) = None -> fault (Evaluate (Name x) k s) (Not_defined x)
| Wrong_self p e k s : of_self p s = inr e -> fault (Evaluate (Self p) k s) e
| Wrong_attribute a v e fs c n s : attribute_of (objects s) v a = inr e -> fault (Have v (Place (Attribute_of a :: fs) c n) s) e
| Wrong_operand v e fs c n s : negative v = inr e -> fault (Have v (Place (Negative_of :: fs) c n) s) e
| Wrong_operands o v1 v2 e fs c n s :
    arithmetic o (as_its position (objects s) v1) (as_its position (objects s) v2) = inr e ->
    fault (Have v2 (Place (Right_of (Arithmetic o) v1 :: fs) c n) s) e
| Wrong_comparison o v1 v2 e fs c n s : compare o v1 v2 = inr e -> fault (Have v2 (Place (Right_of (Compare o) v1 :: fs) c n) s) e
| Wrong_coordinates v1 v2 e fs c n s : vector_of v1 v2 = inr e -> fault (Have v2 (Place (Right_of VectorOf v1 :: fs) c n) s) e
| Wrong_params theta k s : base_dist theta = None -> fault (Sample theta [] k s) Bad_parameters
| Wrong_position own arguments k s : vectors_where_meant (objects s) arguments = false -> fault (Specify own arguments [] k s) No_vector
| Wrong_specifiers own arguments e k s :
    vectors_where_meant (objects s) arguments = true -> resolved own (map fst arguments) = Resolution.Failed e ->
    fault (Specify own arguments [] k s) (Ill_formed e)
| Wrong_with p v e rest outer k s : checked (objects s) p v = inr e -> fault (Construct (Construction (By_with p v :: rest) outer) k s) e
| Wrong_at v e rest outer k s : checked (objects s) position v = inr e -> fault (Construct (Construction (By_at v :: rest) outer) k s) e
| Wrong_default p v e rest outer fs c n s :
    checked (objects s) p v = inr e -> fault (Have v (Place (Defaulting p (Construction rest outer) :: fs) c n) s) e
| Wrong_ego x v n s : assignable x v = false -> fault (Have v (Place [] (Assigning x) n) s) Ego_is_no_object
| Wrong_condition line v n s : (forall b, v <> Truth b) -> fault (Have v (Place [] (Requiring line) n) s) (No_boolean line)
| Wrong_probability line p b rest s : throw p = None -> fault (Execute (SoftRequire line p b :: rest) s) (Bad_probability line)
| Wrong_mutation vs scale e n s : mutated_objects vs scale (objects s) = inr e -> fault (Have scale (Place [] (Scaling vs) n) s) e
| Without_ego s : lookup ego (sigma s) = None -> fault (Execute [] s) No_ego.

(** ** The two agree *)

Ltac split_cases :=
  repeat match goal with
  | H : context [match ?x with _ => _ end] |- _ => destruct x eqn:?; try discriminate
  | H : context [if ?x then _ else _] |- _ => destruct x eqn:?; try discriminate
  end.

Lemma given_value_next A (a : answer A) f c : given_value a f = Next c -> exists v, a = inl v /\ c = f v.
Proof. destruct a; simpl; intros H; inversion H; eauto. Qed.
Lemma given_value_fault A (a : answer A) f e : given_value a f = Fault e -> a = inr e.
Proof. destruct a; simpl; intros H; inversion H; auto. Qed.
Lemma given_value_else A (a : answer A) f o : given_value a f = o -> match o with Next _ | Fault _ => True | _ => False end.
Proof. destruct a; simpl; intros <-; exact I. Qed.

Ltac read_outcome H :=
  first
    [ apply given_value_next in H; destruct H as (? & ? & ->)
    | apply given_value_fault in H
    | now apply given_value_else in H
    | injection H as <- || (injection H as <- <-) || discriminate H ].

Ltac cases H c :=
  destruct c as [[]? ?|?[|[]]? ?|? ?[|[]]? ?|[[|[]]?]? ?|?[[|[| | |? ?|[]?|? ?|? ? ?|? ? ? ?|?[]]?][]?]?|[|[]]?|? ? ?|[|]?|[|]?];
  cbn [machine] in H; split_cases; read_outcome H; subst.

Lemma throw_cases p d i v q : throw p = Some d -> nth_error d i = Some (v, q) -> exists b, v = Truth b.
Proof.
  unfold throw. destruct (_ && _); intros D E; [|discriminate D].
  assert (d = positive [(Truth true, p); (Truth false, 1 - p)%Q]) by congruence. subst d. apply nth_error_In in E.
  apply filter_In in E as [[H|[H|[]]] _]; inversion H; eauto.
Qed.

Ltac convert :=
  repeat match goal with
  | H : Bool.eqb _ _ = true |- _ => apply eqb_prop in H
  | H : Bool.eqb _ _ = false |- _ => apply eqb_false_iff in H
  | H : (_ <? _) = true |- _ => apply Nat.ltb_lt in H
  | H : (_ <? _) = false |- _ => apply Nat.ltb_ge in H
  end.
Ltac convert_back :=
  repeat match goal with
  | H : _ < _ |- _ => apply Nat.ltb_lt in H
  | H : _ <= _ |- _ => apply Nat.ltb_ge in H
  | H : truth_of _ <> _ |- _ => apply eqb_false_iff in H
  end.
Ltac by_rules := convert; subst; econstructor; eauto; try discriminate.
Ltac by_computing :=
  convert_back; subst; cbn [machine];
  repeat match goal with H : ?a = _ |- context [?a] => rewrite H end; cbn [machine given_value]; rewrite ?eqb_reflx; auto.

Lemma next_is_step c c' : machine c = Next c' -> c ⟶ c'.
Proof. intros H. cases H c; by_rules. Qed.

Lemma step_is_next c c' : c ⟶ c' -> machine c = Next c'.
Proof.
  intros H. remember None as silent eqn:E. destruct H; try discriminate E; clear E; try (by_computing; fail).
  destruct e; try discriminate; cbn in *; congruence.
Qed.

Lemma fault_is_fault c e : machine c = Fault e <-> fault c e.
Proof.
  split; intros H; [cases H c; by_rules|destruct H; try (by_computing; fail)].
  destruct v; try reflexivity. now destruct (H b).
Qed.

Lemma stuck_is_stuck c r : machine c = Stuck r <-> stuck_at c r.
Proof. split; intros H; [cases H c; by_rules|destruct H; by_computing]. Qed.

Lemma done_is_done c found : machine c = Done found <-> done c found.
Proof. split; intros H; [cases H c; by_rules|destruct H; by_computing]. Qed.

Lemma draw_is_asked c d resume i v p :
  machine c = Draw d resume -> nth_error d i = Some (v, p) -> c ⟶[(i, v, p)] resume v.
Proof.
  intros H N. cases H c; convert.
  - eapply E_Distributions; eauto.
  - match goal with T : throw _ = _ |- _ => destruct (throw_cases _ _ _ _ _ T N) as [[] ->]; cbn [truth_of] end.
    + eapply S_SoftReq_Check; eauto.
    + eapply S_SoftReq_Skip; eauto.
  - rewrite nth_error_map in N. destruct (nth_error (noise _) i) as [[q w]|] eqn:M; [|discriminate N]. injection N as <- <-.
    eapply T_Mutate_Draw; eauto.
Qed.

Lemma asked_is_draw c i v p c' :
  c ⟶[(i, v, p)] c' -> exists d resume, machine c = Draw d resume /\ nth_error d i = Some (v, p) /\ c' = resume v.
Proof.
  intros H. remember (Some (i, v, p)) as asked eqn:E.
  destruct H; try discriminate E; injection E as -> <- ->; do 2 eexists; (split; [by_computing|split; eauto]).
  rewrite nth_error_map. match goal with N : nth_error (noise _) _ = _ |- _ => now rewrite N end.
Qed.

(** What the function says is what the rules say; a draw offers exactly the answers with which a rule fires. *)
Theorem the_function_says_what_the_rules_say c :
  match machine c with
  | Next c' => c ⟶ c'
  | Draw d resume => forall i v p c', c ⟶[(i, v, p)] c' <-> nth_error d i = Some (v, p) /\ c' = resume v
  | Done found => done c found
  | Stuck r => stuck_at c r
  | Fault e => fault c e
  end.
Proof.
  destruct (machine c) eqn:M.
  - now apply next_is_step.
  - intros i v p c'. split.
    + intros H. apply asked_is_draw in H as (d' & resume' & E & N & ->). rewrite M in E. injection E as <- <-. auto.
    + intros [N ->]. eapply draw_is_asked; eauto.
  - now apply done_is_done.
  - now apply stuck_is_stuck.
  - now apply fault_is_fault.
Qed.

(** and nothing else: what the rules say is what the function says. *)
Theorem the_rules_say_what_the_function_says c :
  (forall c', c ⟶ c' -> machine c = Next c') /\
  (forall i v p c', c ⟶[(i, v, p)] c' -> exists d resume, machine c = Draw d resume /\ nth_error d i = Some (v, p) /\ c' = resume v) /\
  (forall found, done c found -> machine c = Done found) /\
  (forall r, stuck_at c r -> machine c = Stuck r) /\
  (forall e, fault c e -> machine c = Fault e).
Proof.
  repeat split; intros *; [apply step_is_next|apply asked_is_draw|apply done_is_done|apply stuck_is_stuck|apply fault_is_fault].
Qed.

(** * Determinism, given the answers *)

Theorem two_steps_with_one_answer_lead_to_one_configuration c label c1 c2 : step c label c1 -> step c label c2 -> c1 = c2.
Proof.
  destruct label as [[[i v] p]|]; intros H1 H2.
  - apply asked_is_draw in H1 as (d1 & r1 & M1 & _ & ->), H2 as (d2 & r2 & M2 & _ & ->). congruence.
  - apply step_is_next in H1, H2. congruence.
Qed.

(** * Progress *)

Definition exactly_one (statements : list Prop) : Prop :=
  exists i P, nth_error statements i = Some P /\ P /\ forall j R, nth_error statements j = Some R -> R -> j = i.

(** The noise is a distribution, whatever the standard deviation. *)
Definition is_distribution {A} (d : dist A) : Prop := Forall (fun aw => 0 < snd aw)%Q d /\ (mass d == 1)%Q.

Lemma positive_is_positive A (d : dist A) : Forall (fun aw => 0 < snd aw)%Q (positive d).
Proof.
  apply Forall_forall. intros [a w] I. apply filter_In in I as [_ N]. cbn in *. apply negb_true_iff in N.
  destruct (Qlt_le_dec 0 w); [trivial|]. apply Qle_bool_iff in q. congruence.
Qed.

Lemma positive_mass A (d : dist A) : Forall (fun aw => 0 < snd aw)%Q d -> d <> [] -> (0 < mass d)%Q.
Proof.
  intros F N. destruct F as [|[a w] d W F]; [easy|]. unfold mass. rewrite expect_cons. cbn in W.
  assert (0 <= expect (fun _ => 1) d)%Q; [|lra]. apply mass_nonnegative. eapply Forall_impl; [|exact F]. intros ? ?. now apply Qlt_le_weak.
Qed.

Lemma normalised_is_distribution A (d : dist A) : Forall (fun aw => 0 < snd aw)%Q d -> d <> [] -> is_distribution (normalised d).
Proof.
  intros F N. pose proof (positive_mass _ d F N) as M. split; [|apply what_has_mass_has_mass_1_when_normalised; lra].
  unfold normalised, scale. apply Forall_map. eapply Forall_impl; [|exact F]. intros [a w] W. cbn in *.
  apply Qinv_lt_0_compat in M. nra.
Qed.

Lemma base_dist_is_distribution theta d : base_dist theta = Some d -> is_distribution d.
Proof.
  unfold base_dist. destruct (forallb _ _); [|discriminate]. destruct (positive theta) eqn:E; [discriminate|]. intros [= <-].
  apply normalised_is_distribution; [|discriminate]. rewrite <- E. apply positive_is_positive.
Qed.

Lemma throw_is_distribution p d : throw p = Some d -> is_distribution d.
Proof.
  unfold throw. destruct (_ && _) eqn:B; intros D; [|discriminate D].
  assert (d = positive [(Truth true, p); (Truth false, 1 - p)%Q]) as -> by congruence. split; [apply positive_is_positive|].
  apply andb_prop in B as [B C]. apply Qle_bool_iff in B, C. unfold positive. cbn [filter snd].
  assert (forall q, Qle_bool q 0 = false -> 0 < q)%Q as N
    by (intros q E; apply Qnot_le_lt; intros L; apply Qle_bool_iff in L; congruence).
  destruct (Qle_bool p 0) eqn:E, (Qle_bool (1 - p) 0) eqn:F; cbn [negb]; unfold mass; rewrite ?expect_cons;
    (apply Qle_bool_iff in E || apply N in E); (apply Qle_bool_iff in F || apply N in F); cbn; lra.
Qed.

Hypothesis the_noise_is_a_distribution : forall s, (0 < s)%Q -> is_distribution (noise s).

Lemma draws_are_distributions c d resume : machine c = Draw d resume -> is_distribution d.
Proof.
  intros H. cases H c.
  - eapply base_dist_is_distribution; eauto.
  - eapply throw_is_distribution; eauto.
  - match goal with |- is_distribution (map _ (noise ?s)) => assert (is_distribution (noise s)) as [F M] end.
    { apply the_noise_is_a_distribution. apply Qnot_le_lt. intros L. apply Qle_bool_iff in L. unfold is_point_mass in *. congruence. }
    split; [now apply Forall_map|]. rewrite <- M. clear. induction (noise _) as [|[q w] l IH]; [reflexivity|].
    cbn [map]. unfold mass in *. rewrite !expect_cons, IH. reflexivity.
Qed.

Lemma a_distribution_has_values A (d : dist A) : is_distribution d -> exists a w, nth_error d 0 = Some (a, w).
Proof. intros [_ M]. destruct d as [|[a w] d]; [discriminate M|]. now exists a, w. Qed.

Theorem every_configuration_steps_asks_is_done_is_stuck_or_is_a_named_error c :
  exactly_one [
    exists c', c ⟶ c';
    exists i v p c', c ⟶[(i, v, p)] c';
    exists found, done c found;
    exists r, stuck_at c r;
    exists e, fault c e
  ].
Proof.
  pose proof (the_rules_say_what_the_function_says c) as (N & A & D & S & F).
  pose proof (the_function_says_what_the_rules_say c) as H.
  assert (forall k, (match machine c with Next _ => 0 | Draw _ _ => 1 | Done _ => 2 | Stuck _ => 3 | Fault _ => 4 end) = k ->
    forall j R, nth_error [exists c', c ⟶ c'; exists i v p c', c ⟶[(i, v, p)] c'; exists found, done c found;
      exists r, stuck_at c r; exists e, fault c e] j = Some R -> R -> j = k) as only.
  { intros k <- j R E P. destruct j as [|[|[|[|[|j]]]]]; cbn in E; [injection E as <-..|destruct j; discriminate E].
    - destruct P as (? & P). now rewrite (N _ P).
    - destruct P as (? & ? & ? & ? & P). destruct (A _ _ _ _ P) as (? & ? & M & _). now rewrite M.
    - destruct P as (? & P). now rewrite (D _ P).
    - destruct P as (? & P). now rewrite (S _ P).
    - destruct P as (? & P). now rewrite (F _ P). }
  destruct (machine c) eqn:M; [exists 0|exists 1|exists 2|exists 3|exists 4]; eexists; (split; [reflexivity|split; [|now apply only]]).
  - eauto.
  - destruct (a_distribution_has_values _ d) as (v & w & E); [eapply draws_are_distributions; eauto|].
    exists 0, v, w, (resume v). now apply H.
  - eauto.
  - eauto.
  - eauto.
Qed.

(** * Every program ends *)

Definition total {A} (f : A -> nat) := fix go (l : list A) := match l with [] => 0 | a :: l => f a + go l end.

(** How many steps an expression can take, and what is left of an object definition. *)
Definition cost (sizes : list nat) (r : Resolution.result (list (Resolution.specification * list Resolution.property))) : nat :=
  match r with
  | Resolution.Resolved order =>
      total (fun x => match fst x with Resolution.Written _ => 1 | Resolution.Default _ e => 2 + nth (Resolution.text e) sizes 1 end) order
  | Resolution.Failed _ => 0
  end.

Fixpoint size (e : expr) : nat :=
  match e with
  | Constant _ | Name _ | Self _ => 1
  | Attribute e _ | Negative e | Not e => 2 + size e
  | Binary _ e1 e2 | Boolean _ e1 e2 => 3 + size e1 + size e2
  | Discrete params => 2 + total (fun ew => 2 + size (fst ew)) params
  | Object own specifiers =>
      3 + total (fun xe => 2 + size (snd xe)) specifiers + cost (map (fun pe => size (snd pe)) own) (resolved own (map fst specifiers))
  end.

Definition premises_size {A} : list (A * expr) -> nat := total (fun xe => 2 + size (snd xe)).
Definition params_size {A} : list (expr * A) -> nat := total (fun ew => 2 + size (fst ew)).
Definition object_cost own specifiers := cost (map (fun pe => size (snd pe)) own) (resolved own specifiers).
Definition order_size : list specification -> nat := total (fun x => match x with By_default _ e => 2 + size e | _ => 1 end).

Definition frame_size (f : frame) : nat :=
  match f with
  | Attribute_of _ | Negative_of | Not_of | Right_of _ _ => 1
  | Left_of _ e2 => 2 + size e2
  | Boolean_of _ e2 => 1 + size e2
  | Weighing _ _ rest => 2 + params_size rest
  | Specifying own before x rest => 3 + premises_size rest + object_cost own (map fst before ++ x :: map fst rest)
  | Defaulting _ c => 2 + order_size (order c)
  end.

Definition targets_size (es : list expr) : nat := total (fun e => 1 + size e) es.
Definition statement_size (x : statement) : nat :=
  match x with
  | Assign _ e | Param _ e | Require _ e | Expression e => 2 + size e
  | SoftRequire _ _ e => 3 + size e
  | Mutate es scale => 3 + targets_size es + size scale
  end.
Definition context_size (c : context) : nat :=
  match c with Targeting _ rest scale => 2 + targets_size rest + size scale | _ => 1 end.
Definition late_size : list captured -> nat := total (fun c => 2 + size (its_condition c)).
Definition continuation_size (n : continuation) : nat :=
  match n with Then rest => total statement_size rest | Then_late rest _ => late_size rest end.
Definition place_size (k : place) : nat := total frame_size (frames k) + context_size (statement_of k) + continuation_size (next k).

(** The program runs, then Step 1, then the requirements that waited, then Step 2; within each of these, something gets smaller. *)
Definition continuation_phase (n : continuation) : nat := match n with Then _ => 3 | Then_late _ _ => 1 end.
Definition phase (c : config) : nat :=
  match c with
  | Evaluate _ k _ | Sample _ _ k _ | Specify _ _ _ k _ | Construct _ k _ | Have _ k _ => continuation_phase (next k)
  | Execute _ _ => 3
  | Apply_mutations _ _ _ => 2
  | Check_late _ _ => 1
  | Check _ _ => 0
  end.
Definition local (c : config) : nat :=
  match c with
  | Evaluate e k _ => size e + place_size k
  | Sample _ rest k _ => 1 + params_size rest + place_size k
  | Specify own before rest k _ => 2 + premises_size rest + object_cost own (map fst before ++ map fst rest) + place_size k
  | Construct c k _ => 1 + order_size (order c) + place_size k
  | Have _ k _ => place_size k
  | Execute program _ => total statement_size program
  | Apply_mutations i drawn s => 5 * (length (objects s) - i) - Nat.min 3 (length drawn)
  | Check_late rest _ => late_size rest
  | Check premises _ => length premises
  end.

Definition smaller (c' c : config) : Prop := phase c' < phase c \/ phase c' = phase c /\ local c' < local c.

Lemma smaller_is_well_founded : well_founded smaller.
Proof.
  assert (forall p l c, phase c = p -> local c = l -> Acc smaller c) as H; [|now intros c; eapply H].
  induction p as [p IHp] using lt_wf_ind. induction l as [l IHl] using lt_wf_ind. intros c <- <-. constructor.
  intros c' [P|[P L]]; [eapply IHp; [exact P|reflexivity..]|eapply IHl; [exact L|exact P|reflexivity]].
Qed.

Lemma total_app A (f : A -> nat) l m : total f (l ++ m) = total f l + total f m.
Proof. induction l as [|a l IH]; simpl; auto. rewrite IH. lia. Qed.

Lemma built_in_size k e : nth_error (map snd built_in) k = Some e -> size e = 1.
Proof.
  intros H. apply nth_error_In in H. unfold built_in in H. rewrite map_map in H. apply in_map_iff in H as (? & <- & _). reflexivity.
Qed.

Lemma expressions_size own k e : nth_error (expressions own) k = Some e -> size e = nth k (map (fun pe => size (snd pe)) own) 1.
Proof.
  unfold expressions. intros H. destruct (Nat.lt_ge_cases k (length own)) as [L|L].
  - rewrite nth_error_app1 in H by now rewrite map_length. rewrite nth_error_map in H.
    destruct (nth_error own k) as [[p e']|] eqn:E; [|discriminate]. injection H as <-.
    apply (map_nth_error (fun pe => size (snd pe))) in E. symmetry. now apply nth_error_nth.
  - rewrite nth_error_app2 in H by now rewrite map_length. rewrite (built_in_size _ _ H).
    now rewrite nth_overflow by now rewrite map_length.
Qed.

Lemma ordered_size own arguments specifiers order :
  resolved own specifiers = Resolution.Resolved order -> order_size (ordered own arguments order) <= object_cost own specifiers.
Proof.
  unfold object_cost. intros ->. cbn [cost]. unfold ordered, order_size.
  clear specifiers. induction order as [|[x ps] order IH]; [cbn; lia|].
  cbn [flat_map total fst]. rewrite total_app. apply Nat.add_le_mono; [|exact IH].
  destruct x as [s|p e].
  - destruct (nth_error arguments _) as [[[p|] v]|]; cbn; lia.
  - destruct (nth_error (expressions own) _) eqn:E; [|cbn; lia]. apply expressions_size in E. cbn [total]. lia.
Qed.

Lemma nth_error_Some_length A (l : list A) i a : nth_error l i = Some a -> i < length l.
Proof. intros H. apply nth_error_Some. congruence. Qed.

Lemma update_length A n (f : A -> A) l : length (update n f l) = length l.
Proof. revert n; induction l; destruct n; simpl; auto. Qed.

Lemma targets_smaller before rest scale n s :
  phase (targets before rest scale n s) = continuation_phase n /\
  local (targets before rest scale n s) = 1 + targets_size rest + size scale + continuation_size n.
Proof.
  destruct rest; split; try reflexivity; unfold targets; cbn [local]; unfold place_size, targets_size;
    cbn [frames statement_of next total frame_size context_size]; unfold targets_size; lia.
Qed.

Lemma after_smaller n s : phase (after n s) = continuation_phase n /\ local (after n s) = continuation_size n.
Proof. now destruct n. Qed.

Ltac measured :=
  unfold smaller; cbn [phase next inside assigned]; unfold assigned; cbn [phase next];
  rewrite ?(proj1 (targets_smaller _ _ _ _ _)), ?(proj1 (after_smaller _ _));
  first
    [ left; cbn; lia
    | right; split; [reflexivity|];
      rewrite ?(proj2 (targets_smaller _ _ _ _ _)), ?(proj2 (after_smaller _ _));
      unfold local, place_size, params_size, premises_size, targets_size, order_size, late_size;
      cbn [frames statement_of next inside total frame_size context_size continuation_size statement_size fst snd order size its_condition map app];
      unfold local, place_size, params_size, premises_size, targets_size, order_size, late_size;
      cbn [total fst snd order]; rewrite ?map_app, <- ?app_assoc; cbn [map app fst]; try lia ].

Lemma next_is_smaller c c' : machine c = Next c' -> smaller c' c.
Proof.
  intros H. cases H c; convert; try (measured; fail).
  all: right; split; [reflexivity|]; cbn [local size].
  - unfold object_cost, premises_size. cbn [map app]. lia.
  - match goal with R : resolved _ _ = _ |- _ => apply ordered_size with (arguments := before) in R end.
    unfold premises_size. cbn [order total map]. rewrite app_nil_r. lia.
  - rewrite app_length. cbn [length]. match goal with N : nth_error _ _ = Some _ |- _ => apply nth_error_Some_length in N end. lia.
  - cbn [objects with_objects length]. rewrite update_length.
    match goal with N : nth_error _ _ = Some _ |- _ => apply nth_error_Some_length in N end. lia.
  - cbn [length]. match goal with N : nth_error _ _ = Some _ |- _ => apply nth_error_Some_length in N end. lia.
  - cbn [length]. lia.
Qed.

Lemma draw_is_smaller c d resume v : machine c = Draw d resume -> smaller (resume v) c.
Proof.
  intros H. cases H c; convert.
  - measured.
  - destruct (truth_of v); measured.
  - right; split; [reflexivity|]; cbn [local]. rewrite app_length. cbn [length].
    match goal with N : nth_error _ _ = Some _ |- _ => apply nth_error_Some_length in N end. lia.
Qed.

(** * Runs *)

(** How a run ends. *)
Inductive ending := Accepted (found : scene) | Rejected (r : requirement) | Failed (e : error).

(** A run, with the answers to its draws. *)
Inductive run : config -> list answered -> ending -> Prop :=
| run_is_done c found : done c found -> run c [] (Accepted found)
| run_is_stuck c r : stuck_at c r -> run c [] (Rejected r)
| run_fails c e : fault c e -> run c [] (Failed e)
| run_goes_on c c' answers e : c ⟶ c' -> run c' answers e -> run c answers e
| run_asks c a c' answers e : c ⟶[a] c' -> run c' answers e -> run c (a :: answers) e.

(** "The product of the probabilities of all rewrite rules yields a probability for the trace." *)
Definition weight (answers : list answered) : Q := fold_right (fun a w => snd a * w)%Q 1%Q answers.

(** All runs, depth first, as inference/enumeration.py finds them; None, if there is a run of more than [n] steps. *)
Fixpoint branches (found : config -> option (list (list answered * ending))) (resume : value -> config) (i : nat) (d : dist value) :=
  match d with
  | [] => Some []
  | (v, p) :: d =>
      match found (resume v), branches found resume (S i) d with
      | Some rs, Some others => Some (map (fun r => ((i, v, p) :: fst r, snd r)) rs ++ others)
      | _, _ => None
      end
  end.
Fixpoint runs (n : nat) (c : config) : option (list (list answered * ending)) :=
  match n with
  | 0 => None
  | S n =>
      match machine c with
      | Next c' => runs n c'
      | Draw d resume => branches (runs n) resume 0 d
      | Done found => Some [([], Accepted found)]
      | Stuck r => Some [([], Rejected r)]
      | Fault e => Some [([], Failed e)]
      end
  end.

Lemma branches_grow f g resume : (forall v rs, f (resume v) = Some rs -> g (resume v) = Some rs) ->
  forall d i bs, branches f resume i d = Some bs -> branches g resume i d = Some bs.
Proof.
  intros G. induction d as [|[v p] d IH]; intros i bs H; cbn in *; [trivial|].
  destruct (f (resume v)) eqn:E; [|discriminate]. destruct (branches f resume (S i) d) eqn:B; [|discriminate].
  now rewrite (G _ _ E), (IH _ _ B).
Qed.

Lemma more_steps_find_the_same_runs n c rs : runs n c = Some rs -> forall m, n <= m -> runs m c = Some rs.
Proof.
  revert c rs. induction n as [|n IH]; intros c rs H m L; [discriminate|]. destruct m as [|m]; [lia|]. cbn in *.
  destruct (machine c); trivial; [apply IH; [trivial|lia]|].
  eapply branches_grow; [|exact H]. intros v rs' E. apply IH; [trivial|lia].
Qed.

Theorem every_program_ends c : exists n rs, runs n c = Some rs.
Proof.
  induction c as [c IH] using (well_founded_induction smaller_is_well_founded).
  destruct (machine c) eqn:M; try (exists 1; cbn; rewrite M; eauto; fail).
  - destruct (IH c0) as (n & rs & H); [now apply next_is_smaller|]. exists (S n), rs. cbn. now rewrite M.
  - assert (forall i, exists n bs, branches (runs n) resume i d = Some bs) as B.
    { assert (forall v, smaller (resume v) c) as L by (intros; eapply draw_is_smaller; eauto). clear M.
      induction d as [|[v p] d IHd]; intros i; [now exists 0, []|].
      destruct (IH _ (L v)) as (n & rs & H), (IHd (S i)) as (m & bs & K). exists (n + m). cbn [branches].
      rewrite (more_steps_find_the_same_runs _ _ _ H (n + m)) by lia.
      rewrite (branches_grow (runs m) (runs (n + m)) resume) with (bs := bs); [eauto| |trivial].
      intros w rs' E. eapply more_steps_find_the_same_runs; [exact E|lia]. }
    destruct (B 0) as (n & bs & H). exists (S n), bs. cbn. now rewrite M.
Qed.

Lemma branches_are f resume d : forall i bs, branches f resume i d = Some bs -> forall answers e,
  In (answers, e) bs <-> exists j v p rest rs,
    nth_error d j = Some (v, p) /\ answers = (i + j, v, p) :: rest /\ f (resume v) = Some rs /\ In (rest, e) rs.
Proof.
  induction d as [|[v p] d IH]; intros i bs H answers e; cbn in H.
  - injection H as <-. split; [intros []|]. intros ([|] & ? & ? & ? & ? & N & _); discriminate.
  - destruct (f (resume v)) as [rs|] eqn:E; [|discriminate]. destruct (branches f resume (S i) d) as [others|] eqn:B; [|discriminate].
    injection H as <-. rewrite in_app_iff, in_map_iff, (IH _ _ B). split.
    + intros [([rest e'] & [= <- <-] & I)|(j & w & q & rest & rs' & N & -> & F & I)].
      * exists 0, v, p, rest, rs. rewrite Nat.add_0_r. auto.
      * exists (S j), w, q, rest, rs'. rewrite <- Nat.add_succ_comm. auto.
    + intros ([|j] & w & q & rest & rs' & N & -> & F & I); cbn in N.
      * left. injection N as <- <-. rewrite E in F. injection F as <-. rewrite Nat.add_0_r. now exists (rest, e).
      * right. exists j, w, q, rest, rs'. rewrite Nat.add_succ_comm. auto.
Qed.

Theorem the_runs_found_are_the_runs n c rs : runs n c = Some rs -> forall answers e, run c answers e <-> In (answers, e) rs.
Proof.
  intros H answers e. split.
  - intros R. revert n rs H. induction R as [c found D|c r D|c e D|c c' answers e D R IH|c [[i v] p] c' answers e D R IH];
      intros n rs H; (destruct n as [|n]; [discriminate|]); cbn in H.
    + apply done_is_done in D. rewrite D in H. injection H as <-. now left.
    + apply stuck_is_stuck in D. rewrite D in H. injection H as <-. now left.
    + apply fault_is_fault in D. rewrite D in H. injection H as <-. now left.
    + apply step_is_next in D. rewrite D in H. eauto.
    + apply asked_is_draw in D as (d & resume & M & N & ->). rewrite M in H. apply (branches_are _ _ _ _ _ H).
      assert (exists rs', runs n (resume v) = Some rs') as (rs' & E).
      { clear - H N. revert H N. generalize 0 as k. revert i rs. induction d as [|[w q] d IHd]; intros i rs k H N; [destruct i; discriminate|].
        cbn in H. destruct (runs n (resume w)) eqn:E; [|discriminate]. destruct (branches (runs n) resume (S k) d) eqn:B; [|discriminate].
        destruct i; [injection N as -> ->; eauto|eapply IHd; eauto]. }
      exists i, v, p, answers, rs'. repeat split; eauto.
  - revert c rs answers e H. induction n as [|n IH]; intros c rs answers e H I; [discriminate|]. cbn in H.
    destruct (machine c) eqn:M.
    + eapply run_goes_on; [apply next_is_step; eauto|eauto].
    + apply (branches_are _ _ _ _ _ H) in I as (j & v & p & rest & rs' & N & -> & F & I). cbn [Nat.add].
      eapply run_asks; [eapply draw_is_asked; eauto|eauto].
    + injection H as <-. destruct I as [[= <- <-]|[]]. now apply run_is_done, done_is_done.
    + injection H as <-. destruct I as [[= <- <-]|[]]. now apply run_is_stuck, stuck_is_stuck.
    + injection H as <-. destruct I as [[= <- <-]|[]]. now apply run_fails, fault_is_fault.
Qed.

Lemma disjoint_lists A (l m : list A) : NoDup l -> NoDup m -> (forall x, In x l -> ~ In x m) -> NoDup (l ++ m).
Proof.
  intros L M D. induction L as [|a l N L IH]; [trivial|]. cbn. constructor; [|apply IH; intros x I; apply D; now right].
  rewrite in_app_iff. intros [I|I]; [auto|]. apply (D a); [now left|trivial].
Qed.

Theorem no_run_is_found_twice n c rs : runs n c = Some rs -> NoDup (map fst rs).
Proof.
  revert c rs. induction n as [|n IH]; intros c rs H; [discriminate|]. cbn in H.
  destruct (machine c); eauto; try (injection H as <-; repeat constructor; intros []; fail).
  revert rs H. generalize 0 as i. induction d as [|[v p] d IHd]; intros i rs H; cbn in H; [injection H as <-; constructor|].
  destruct (runs n (resume v)) as [one|] eqn:E; [|discriminate].
  destruct (branches (runs n) resume (S i) d) as [others|] eqn:B; [|discriminate]. injection H as <-.
  rewrite map_app, map_map. cbn [fst].
  apply disjoint_lists; [|eauto|].
  - replace (map _ one) with (map (cons (i, v, p)) (map fst one)) by apply map_map.
    apply Injective_map_NoDup; [|eauto]. intros a b [= ->]. reflexivity.
  - intros x I J. apply in_map_iff in I as (r & <- & _), J as ([answers e] & F & J). cbn in F. subst answers.
    apply (branches_are _ _ _ _ _ B) in J as (j & w & q & rest & rs' & _ & G & _). injection G as G _ _ _. lia.
Qed.

Theorem the_answers_to_draws_determine_the_run c answers e1 e2 : run c answers e1 -> run c answers e2 -> e1 = e2.
Proof.
  destruct (every_program_ends c) as (n & rs & H). rewrite !(the_runs_found_are_the_runs _ _ _ H).
  pose proof (no_run_is_found_twice _ _ _ H) as N. clear H. induction rs as [|[a e] rs IH]; [intros []|].
  cbn in N. inversion N as [|? ? O M]; subst. intros [I|I] [J|J]; [congruence| | |auto]; exfalso; apply O; apply (in_map fst) in I || idtac.
  - injection I as -> ->. now apply (in_map fst) in J.
  - injection J as -> ->. exact I.
Qed.

(** * The distribution of a program *)

(** How the runs end, with their probabilities. *)
Definition weighted (rs : list (list answered * ending)) : dist ending := map (fun r => (snd r, weight (fst r))) rs.

Lemma weighted_branch a rs : weighted (map (fun r => (a :: fst r, snd r)) rs) ≈ scale (snd a) (weighted rs).
Proof.
  intros f. rewrite expect_scale. induction rs as [|[answers e] rs IH]; [cbn; ring|].
  unfold weighted in *. cbn [map fst snd]. rewrite !expect_cons, IH. cbn [weight fold_right]. unfold weight. ring.
Qed.

(** A draw makes of the distributions after each of its answers their mixture. *)
Theorem the_distribution_at_a_draw_is_a_mixture n c d resume rs :
  machine c = Draw d resume -> runs (S n) c = Some rs ->
  weighted rs ≈ bind d (fun v => match runs n (resume v) with Some rs => weighted rs | None => [] end).
Proof.
  cbn. intros -> H f. rewrite expect_bind. revert rs H. generalize 0 as i.
  induction d as [|[v p] d IH]; intros i rs H; cbn in H; [now injection H as <-|].
  destruct (runs n (resume v)) as [one|] eqn:E; [|discriminate].
  destruct (branches (runs n) resume (S i) d) as [others|] eqn:B; [|discriminate]. injection H as <-.
  rewrite expect_cons, <- (IH _ _ B), E. unfold weighted. rewrite map_app, expect_app.
  fold (weighted others). rewrite <- expect_scale. apply Qplus_comp; [|reflexivity]. apply (weighted_branch (i, v, p)).
Qed.

(** "Done", "stuck at a requirement" and "in error" are all the ways in which a run can end. *)
Theorem the_masses_of_all_runs_add_up_to_1 n c rs : runs n c = Some rs -> (mass (weighted rs) == 1)%Q.
Proof.
  revert c rs. induction n as [|n IH]; intros c rs H; [discriminate|]. destruct (machine c) eqn:M.
  - cbn in H. rewrite M in H. eauto.
  - pose proof (the_distribution_at_a_draw_is_a_mixture _ _ _ _ _ M H) as E. rewrite E, mass_of_bind.
    destruct (draws_are_distributions _ _ _ M) as [_ U]. rewrite <- U. apply expect_ext_in. intros v p I.
    cbn in H. rewrite M in H. clear - H I IH. revert rs H. generalize 0 as i.
    induction d as [|[w q] d IHd]; intros i rs H; [destruct I|]. cbn in H.
    destruct (runs n (resume w)) as [one|] eqn:E; [|discriminate].
    destruct (branches (runs n) resume (S i) d) eqn:B; [|discriminate].
    destruct I as [[= -> ->]|I]; [rewrite E; eauto|eauto].
  - cbn in H. rewrite M in H. injection H as <-. reflexivity.
  - cbn in H. rewrite M in H. injection H as <-. reflexivity.
  - cbn in H. rewrite M in H. injection H as <-. reflexivity.
Qed.

Theorem every_run_has_a_positive_probability c answers e : run c answers e -> (0 < weight answers)%Q.
Proof.
  induction 1 as [| | | |c [[i v] p] c' answers e S R IH]; cbn; try lra.
  apply asked_is_draw in S as (d & resume & M & N & _). destruct (draws_are_distributions _ _ _ M) as [F _].
  rewrite Forall_forall in F. apply nth_error_In in N. specialize (F _ N). cbn in F. fold (weight answers). nra.
Qed.

(** ** What is done, stuck and wrong *)

Definition is_accepted (e : ending) : bool := match e with Accepted _ => true | _ => false end.
Definition is_rejected (e : ending) : bool := match e with Rejected _ => true | _ => false end.
Definition is_failed (e : ending) : bool := match e with Failed _ => true | _ => false end.

Theorem the_masses_of_done_stuck_and_wrong_runs_add_up_to_1 n c rs :
  runs n c = Some rs -> (pr is_accepted (weighted rs) + pr is_rejected (weighted rs) + pr is_failed (weighted rs) == 1)%Q.
Proof.
  intros H. rewrite <- (the_masses_of_all_runs_add_up_to_1 _ _ _ H). unfold pr, mass. rewrite <- !expect_plus.
  apply expect_ext. now intros [].
Qed.

(** "If we discard all traces which do not terminate (due to violating a requirement), then normalizing the probabilities of the
    remaining traces yields a distribution over traces, and therefore scenes, that satisfy all our requirements." *)
Definition scenes (d : dist ending) : dist scene := bind d (fun e => match e with Accepted found => ret found | _ => Distribution.stuck end).
Definition law (rs : list (list answered * ending)) : dist scene := normalised (scenes (weighted rs)).

Lemma expect_scenes f d : (expect f (scenes d) == expect (fun e => match e with Accepted found => f found | _ => 0 end) d)%Q.
Proof.
  unfold scenes. rewrite expect_bind. apply expect_ext. intros []; [apply expect_ret|apply expect_stuck|apply expect_stuck].
Qed.

Lemma law_of_a_list rs E :
  (pr E (law rs)
   == pr (fun e => match e with Accepted found => E found | _ => false end) (weighted rs) / pr is_accepted (weighted rs))%Q.
Proof.
  unfold law. rewrite pr_normalised. unfold pr, mass. rewrite !expect_scenes. unfold Qdiv. apply Qmult_comp.
  - apply expect_ext. now intros [].
  - apply Qinv_comp, expect_ext. now intros [].
Qed.

Lemma law_of_a_part (kept : ending -> bool) rs :
  (forall found, kept (Accepted found) = true) -> law (filter (fun r => kept (snd r)) rs) ≈ law rs.
Proof.
  intros K. unfold law. apply normalised_respects. intros f. rewrite !expect_scenes.
  induction rs as [|[answers e] rs IH]; [reflexivity|]. cbn [filter snd]. unfold weighted in *.
  destruct e; [rewrite K|destruct (kept _)..]; cbn [map fst snd]; rewrite ?expect_cons, <- IH; try reflexivity; rewrite ?expect_cons; ring.
Qed.

Lemma expect_permuted A f (d d' : dist A) : Permutation d d' -> (expect f d == expect f d')%Q.
Proof.
  intros P. induction P as [|[a w] d d' P IH|[a w] [b v] d|d d' d'' P IH P' IH']; [reflexivity| | |now rewrite IH].
  - now rewrite !expect_cons, IH.
  - rewrite !expect_cons. ring.
Qed.

(** Some of the runs of a configuration, each once: those of which `kept` is true of how they end. *)
Definition those_runs (kept : ending -> bool) (c : config) (some : list (list answered * ending)) : Prop :=
  NoDup some /\ forall answers e, In (answers, e) some <-> run c answers e /\ kept e = true.

Lemma law_of_those_runs kept n c rs some : (forall found, kept (Accepted found) = true) ->
  runs n c = Some rs -> those_runs kept c some -> law some ≈ law rs.
Proof.
  intros K H [N I]. rewrite <- (law_of_a_part kept rs K).
  assert (Permutation some (filter (fun r => kept (snd r)) rs)) as P.
  { apply NoDup_Permutation; [exact N|apply NoDup_filter, (NoDup_map_inv fst), (no_run_is_found_twice n c rs H)|].
    intros [answers e]. rewrite I, filter_In, (the_runs_found_are_the_runs n c rs H). reflexivity. }
  unfold law. apply normalised_respects. intros f. rewrite !expect_scenes. apply expect_permuted. now apply Permutation_map.
Qed.

Theorem the_law_of_scenes_is_that_of_done_runs_divided_by_their_mass n c rs accepted E :
  runs n c = Some rs -> those_runs is_accepted c accepted ->
  (pr E (law rs)
   == pr (fun e => match e with Accepted found => E found | _ => false end) (weighted accepted) / mass (weighted accepted))%Q.
Proof.
  intros H A. assert (law accepted ≈ law rs) as L by (eapply law_of_those_runs; eauto; reflexivity).
  unfold pr at 1. rewrite <- (L _). fold (pr E (law accepted)). rewrite law_of_a_list. unfold Qdiv. apply Qmult_comp; [reflexivity|].
  apply Qinv_comp, expect_ext_in. intros e w I. apply in_map_iff in I as ([answers e'] & [= -> _] & I).
  apply A in I as [_ I]. cbn in I |- *. now rewrite I.
Qed.

Theorem a_stuck_run_contributes_nothing n c rs others :
  runs n c = Some rs -> those_runs (fun e => negb (is_rejected e)) c others -> law others ≈ law rs.
Proof. intros H O. eapply law_of_those_runs; eauto. reflexivity. Qed.

Theorem the_law_has_mass_1_if_some_run_is_done n c rs answers found :
  runs n c = Some rs -> run c answers (Accepted found) -> (mass (law rs) == 1)%Q.
Proof.
  intros H R. apply what_has_mass_has_mass_1_when_normalised. unfold mass. rewrite expect_scenes.
  assert (Forall (fun aw => 0 <= snd aw)%Q (weighted rs)) as N.
  { apply Forall_map, Forall_forall. intros [a e] I. cbn. apply Qlt_le_weak.
    eapply every_run_has_a_positive_probability, the_runs_found_are_the_runs; eauto. }
  pose proof (every_run_has_a_positive_probability _ _ _ R) as P. apply (the_runs_found_are_the_runs _ _ _ H) in R. clear H.
  assert (weight answers <= expect (fun e => match e with Accepted _ => 1 | _ => 0 end) (weighted rs))%Q; [|lra].
  induction rs as [|[a e] rs IH]; [destruct R|]. unfold weighted in *. cbn [map fst snd] in *. inversion N; subst.
  rewrite expect_cons. cbn [snd] in *.
  assert (0 <= expect (fun e => match e with Accepted _ => 1 | _ => 0 end) (map (fun r => (snd r, weight (fst r))) rs))%Q
    by (apply expect_nonnegative; [assumption|intros []; lra]).
  destruct R as [[= -> ->]|R]; [lra|]. specialize (IH R ltac:(assumption)). destruct e; nra.
Qed.

(** An error in any run is an error of the program (`docs/enumeration.md`): a program has a law, or errors. *)
Definition errors (rs : list (list answered * ending)) : list error :=
  flat_map (fun r => match snd r with Failed e => [e] | _ => [] end) rs.
Definition meaning (rs : list (list answered * ending)) : dist scene + list error :=
  match errors rs with [] => inl (law rs) | wrong => inr wrong end.

Theorem errors_are_kept_apart n c rs : runs n c = Some rs ->
  match meaning rs with
  | inl found =>
      found = law rs /\ (forall answers e, ~ run c answers (Failed e)) /\
      (pr is_accepted (weighted rs) + pr is_rejected (weighted rs) == 1)%Q
  | inr wrong => wrong <> [] /\ forall e, In e wrong <-> exists answers, run c answers (Failed e)
  end.
Proof.
  intros H.
  assert (forall e, In e (errors rs) <-> exists answers, run c answers (Failed e)) as E.
  { intros e. unfold errors. rewrite in_flat_map. split.
    - intros ([answers [| |e']] & I & J); cbn in J; try tauto. destruct J as [->|[]]. exists answers. now apply (the_runs_found_are_the_runs _ _ _ H).
    - intros (answers & R). apply (the_runs_found_are_the_runs _ _ _ H) in R. exists (answers, Failed e). cbn. auto. }
  unfold meaning. destruct (errors rs) as [|e wrong] eqn:W; [|split; [discriminate|exact E]].
  split; [reflexivity|]. assert (forall answers e, ~ run c answers (Failed e)) as N by (intros answers e R; apply (E e); eauto).
  split; [exact N|]. rewrite <- (the_masses_of_done_stuck_and_wrong_runs_add_up_to_1 _ _ _ H).
  assert (pr is_failed (weighted rs) == 0)%Q as ->; [|ring]. unfold pr. rewrite <- (expect_zero _ (weighted rs)). apply expect_ext_in.
  intros e w I. unfold weighted in I. apply in_map_iff in I as ([answers e'] & [= <- <-] & I). cbn [snd].
  destruct e'; cbn; try reflexivity. destruct (N answers e). now apply (the_runs_found_are_the_runs _ _ _ H).
Qed.

End Machine.

(** * Upright boxes

    Where no object is turned, bounding boxes and what is seen of them can be computed: the geometry of the programs that the tests run
    on this machine. Most of these have no noise; in others it has two values, which are not equally likely. *)

Definition between (o1 o2 : bindings) : Q * Q :=
  match lookup position o1, lookup position o2 with
  | Some (Vector x y), Some (Vector x' y') => (Qabs (x' - x), Qabs (y' - y))%Q
  | _, _ => (0, 0)%Q
  end.

(** Boxes that touch intersect (the reading `touching`). *)
Definition upright_boxes_intersect (o1 o2 : bindings) : bool :=
  let (x, y) := between o1 o2 in
  Qle_bool x ((read width o1 + read width o2) / 2) && Qle_bool y ((read extent o1 + read extent o2) / 2).

(** Some point of the second box is at most viewDistance away from the first position; the viewAngle is 360 degrees. *)
Definition sees_upright_box (o1 o2 : bindings) : bool :=
  let (x, y) := between o1 o2 in
  let outside d side := if Qle_bool d (side / 2) then 0%Q else (d - side / 2)%Q in
  let dx := outside x (read width o2) in
  let dy := outside y (read extent o2) in
  Qle_bool (dx * dx + dy * dy) (read viewDistance o1 * read viewDistance o1).

Definition no_noise (s : Q) : dist Q := ret 0%Q.

Theorem the_law_without_noise_is_a_distribution s : (0 < s)%Q -> is_distribution (no_noise s).
Proof. intros _. split; [repeat constructor|reflexivity]. Qed.

Definition lopsided_noise (s : Q) : dist Q := [(Qred (s / 2), 1 # 4); (Qred (- s), 3 # 4)]%Q.

Theorem the_law_of_lopsided_noise_is_a_distribution s : (0 < s)%Q -> is_distribution (lopsided_noise s).
Proof. intros _. split; [repeat constructor|reflexivity]. Qed.

Definition begin (program : list statement) : config := Execute program (State [] [] [] None []).

(** All runs of a program whose objects are upright and have no noise, if they have at most [n] steps each. *)
Definition upright_runs (at_the_end : bool) (n : nat) (program : list statement) :=
  runs (Qmake 5 57) no_noise upright_boxes_intersect sees_upright_box at_the_end n (begin program).
