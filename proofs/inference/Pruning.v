(** The pruning algorithms keep every position that meets their geometric premises: `inference/pruning/algorithms.py`. The paper's Section
    "Domain-Specific Sampling Techniques" and Appendix "Sampling Algorithms". What follows for the conditional distribution is in
    `PrunedDistribution` and `PrunedScenarios`.

    A region is the set of its points. Angles are real numbers here, of which no turn is taken away. *)
From Coq Require Import Reals Lra Lia Psatz List.
From ScenicRef Require Import scenes.Operators.
Import ListNotations.
Local Open Scope R_scope.

Definition region : Type := vector -> Prop.
Definition dilate (r : region) (d : R) : region := fun x => exists y, r y /\ distance x y <= d.
Definition erode (r : region) (d : R) : region := fun x => forall y, distance x y <= d -> r y.
Definition included (r s : region) : Prop := forall x, r x -> s x.

(** boundingBox(O): what is at most half the width to the side of the centre, and half the length before or behind it. *)
Definition box (centre : vector) (h : heading) (width length : R) : region := fun y =>
  exists v, y = offset_local centre h v /\ Rabs (fst v) <= width / 2 /\ Rabs (snd v) <= length / 2.

Lemma coordinate_within v : Rabs (fst v) <= length v /\ Rabs (snd v) <= length v.
Proof.
  unfold length; split; rewrite <- sqrt_Rsqr_abs; apply sqrt_le_1_alt; unfold Rsqr, square; nra.
Qed.

(** * Pruning based on containment *)

Theorem a_box_holds_the_disc_of_its_inradius x h width length r y :
  is_heading h -> r <= width / 2 -> r <= length / 2 -> distance x y <= r -> box x h width length y.
Proof.
  intros H W L D; exists (rotate (minus y x) (back h)).
  assert (is_heading (back h)) as B by (now apply (headings_are_a_commutative_group h h h)).
  destruct (coordinate_within (rotate (minus y x) (back h))) as [X Y]; rewrite rotation_preserves_lengths in X, Y by exact B.
  unfold distance in D. repeat split; try lra.
  unfold offset_local. destruct (rotation_can_be_undone (minus y x) h H) as [_ ->]. destruct x, y; unfold minus, plus, opposite; simpl; f_equal; ring.
Qed.

Theorem pruning_by_containment_keeps_every_position_of_an_object_that_is_contained (positions container : region) x h width length min_radius :
  is_heading h -> min_radius <= width / 2 -> min_radius <= length / 2 ->
  positions x -> included (box x h width length) container ->
  positions x /\ erode container min_radius x.
Proof. intros H W L P C; split; [exact P|]. intros y D. apply C, a_box_holds_the_disc_of_its_inradius with min_radius; assumption. Qed.

(** * Pruning based on orientation *)

(** A polygon of the map, and the angle of the vector field in it. *)
Definition cell : Type := region * R.

(** pruneByHeading(map, A, M, δ): "relHead(P, Q) ± 2δ ∈ A" says that the interval meets A (reading `prune-heading`). *)
Definition pruned_by_heading (map : list cell) (allowed : R -> Prop) (m delta : R) : region := fun x =>
  exists p q, In p map /\ In q map /\ fst p x /\ dilate (fst q) m x /\
  exists a, Rabs (a - (snd q - snd p)) <= 2 * delta /\ allowed a.

(** X is in a cell of the map, and its heading differs from the cell's by at most δ. The δ of the algorithm may be the mean of two. *)
Definition is_aligned (map : list cell) (delta : R) (x : vector) (angle : R) (p : cell) : Prop :=
  In p map /\ fst p x /\ Rabs (angle - snd p) <= delta.

Theorem pruning_by_heading_keeps_every_position_of_an_object_whose_relative_heading_is_allowed
  map (allowed : R -> Prop) m delta delta_x delta_y x y hx hy p q :
  delta_x + delta_y <= 2 * delta ->
  is_aligned map delta_x x hx p -> is_aligned map delta_y y hy q -> distance x y <= m -> allowed (hy - hx) ->
  pruned_by_heading map allowed m delta x.
Proof.
  intros S (P & Px & Hp) (Q & Qy & Hq) D A; exists p, q; repeat split; try assumption; [exists y; now split|].
  exists (hy - hx); split; [|exact A]. unfold Rabs in *; repeat destruct Rcase_abs; lra.
Qed.

(** The other way to read it, that all of the interval lies in A, would lose positions. *)
Definition pruned_where_all_are_allowed (map : list cell) (allowed : R -> Prop) (m delta : R) : region := fun x =>
  exists p q, In p map /\ In q map /\ fst p x /\ dilate (fst q) m x /\
  forall a, Rabs (a - (snd q - snd p)) <= 2 * delta -> allowed a.

Theorem were_all_of_the_interval_to_be_allowed_positions_would_be_lost :
  exists (map : list cell) (allowed : R -> Prop) (m delta : R) (x y : vector) (hx hy : R) (p q : cell),
  is_aligned map delta x hx p /\ is_aligned map delta y hy q /\ distance x y <= m /\ allowed (hy - hx) /\
  ~ pruned_where_all_are_allowed map allowed m delta x.
Proof.
  set (c := ((fun _ => True) : region, 0)).
  exists [c], (fun a => a = 0), 0, 1, (0, 0), (0, 0), 0, 0, c, c.
  assert (is_aligned [c] 1 (0, 0) 0 c) as A.
  { repeat split; [now left|]. unfold c; simpl; rewrite Rminus_0_r, Rabs_R0; lra. }
  repeat split; try apply A; try lra.
  - unfold distance, length, square, minus, plus, opposite; simpl. replace (_ + _) with 0 by ring. rewrite sqrt_0; lra.
  - intros (p & q & Hp & Hq & _ & _ & F). destruct Hp as [<-|[]], Hq as [<-|[]]; simpl in F.
    specialize (F 1). rewrite !Rminus_0_r, Rabs_R1 in F. lra.
Qed.

(** * Pruning based on size *)

Definition oriented_cell : Type := region * heading.

(** How far to the right of v a point w is, along a heading. *)
Definition across (h : heading) (v w : vector) : R := fst (rotate (minus w v) (back h)).

(** `narrow`: no two points of the cell are so far apart across its heading. *)
Definition narrow (min_width : R) (p : oriented_cell) : Prop :=
  forall v w, fst p v -> fst p w -> Rabs (across (snd p) v w) < min_width.

(** pruneByWidth(map, M, minWidth). Whether a cell is narrow, and whether a point lies in it, is decided: the theorem's first premises. *)
Definition pruned_by_width (map : list oriented_cell) (m min_width : R) : region := fun x =>
  (exists p, In p map /\ ~ narrow min_width p /\ fst p x) \/
  (exists p q, In p map /\ narrow min_width p /\ fst p x /\ In q map /\ q <> p /\ dilate (fst q) m x).

Theorem pruning_by_width_keeps_every_position_of_a_configuration_that_is_wide map m min_width p x y z :
  (narrow min_width p \/ ~ narrow min_width p) -> (fst p y \/ ~ fst p y) ->
  In p map -> fst p x -> (exists q, In q map /\ fst q y) -> (exists q, In q map /\ fst q z) ->
  distance x y <= m -> distance x z <= m -> min_width <= Rabs (across (snd p) y z) ->
  pruned_by_width map m min_width x.
Proof.
  intros [N|N] Y P Px (q & Q & Qy) (r & R & Rz) Dy Dz W; [right; destruct Y as [Py|Py]|left; now exists p].
  - exists p, r; repeat split; try assumption; [|exists z; now split].
    intros ->. specialize (N y z Py Rz). lra.
  - exists p, q; repeat split; try assumption; [now intros ->|exists y; now split].
Qed.

(** * Pruning based on reachability *)

(** The positions of a run, one after the other: each step takes `dt`, at no more than the greatest speed. *)
Fixpoint drives (speed dt : R) (x : vector) (path : list vector) : Prop :=
  match path with
  | [] => True
  | y :: rest => distance x y <= speed * dt /\ drives speed dt y rest
  end.

Lemma last_of_more (rest : list vector) : forall x y, last (y :: rest) x = last rest y.
Proof.
  induction rest as [|z rest IH]; intros x y; [reflexivity|].
  change (last (z :: rest) x = last (z :: rest) y). now rewrite !IH.
Qed.

Lemma a_path_is_no_longer_than_speed_times_time speed dt path : forall x,
  drives speed dt x path -> distance x (last path x) <= speed * (INR (List.length path) * dt).
Proof.
  induction path as [|y rest IH]; intros x D.
  - simpl. rewrite Rmult_0_l, Rmult_0_r. unfold distance, length, square, minus, plus, opposite; simpl.
    replace (_ + _) with 0 by ring. rewrite sqrt_0; lra.
  - destruct D as [D E]. specialize (IH y E).
    rewrite last_of_more.
    change (List.length (y :: rest)) with (S (List.length rest)); rewrite S_INR.
    pose proof (the_way_round_is_not_shorter x y (last rest y)). lra.
Qed.

Theorem pruning_by_reachability_keeps_every_start_from_which_the_goal_is_reached (goal : region) speed dt time x path :
  0 <= speed -> drives speed dt x path -> INR (List.length path) * dt <= time -> goal (last path x) -> dilate goal (speed * time) x.
Proof.
  intros S D T G; exists (last path x); split; [exact G|].
  pose proof (a_path_is_no_longer_than_speed_times_time speed dt path x D). nra.
Qed.

(** "If the object is also required to stay within some containing region C (e.g., a road) for the entire duration of the scenario, we can compute a
    tighter value of D by considering only paths that lie within C": the starts from which the goal is reached in so many pieces, each of which
    begins and ends in the container. *)
Fixpoint reached_within (goal container : region) (piece : R) (pieces : nat) : region :=
  match pieces with
  | O => fun x => goal x /\ container x
  | S n => fun x => dilate (reached_within goal container piece n) piece x /\ container x
  end.

(** Where something is at each time from 0 to its arrival, at no more than the greatest speed. *)
Definition moves_at_most_at (speed : R) (path : R -> vector) (arrival : R) : Prop :=
  forall s t, 0 <= s <= t -> t <= arrival -> distance (path s) (path t) <= speed * (t - s).

Theorem pruning_by_reachability_within_a_container_keeps_every_start_from_which_the_goal_is_reached_inside
  (goal container : region) speed time pieces path arrival :
  (0 < pieces)%nat -> 0 <= speed -> 0 <= arrival <= time -> moves_at_most_at speed path arrival ->
  (forall t, 0 <= t <= arrival -> container (path t)) -> goal (path arrival) ->
  reached_within goal container (speed * time / INR pieces) pieces (path 0).
Proof.
  intros N V [A T] M C G. assert (0 < INR pieces) as P by (now apply lt_0_INR).
  set (part := arrival / INR pieces). assert (0 <= part) as Q by (apply Rmult_le_pos; [exact A|now apply Rlt_le, Rinv_0_lt_compat]).
  assert (INR pieces * part = arrival) as E by (unfold part; field; lra).
  assert (forall k, (k <= pieces)%nat -> reached_within goal container (speed * time / INR pieces) k (path (arrival - INR k * part))) as W.
  { induction k as [|k IH]; intro L.
    - replace (arrival - INR 0 * part) with arrival by (simpl; ring). split; [exact G|apply C; lra].
    - assert (INR (S k) * part <= arrival) as B by (rewrite <- E; apply Rmult_le_compat_r; [exact Q|now apply le_INR]).
      rewrite S_INR in *. pose proof (pos_INR k). assert (0 <= INR k * part) by (now apply Rmult_le_pos). split; [|apply C; lra].
      exists (path (arrival - INR k * part)). split; [apply IH; lia|].
      eapply Rle_trans; [apply M; lra|]. replace (arrival - INR k * part - (arrival - (INR k + 1) * part)) with part by ring.
      unfold part, Rdiv. rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [now apply Rlt_le, Rinv_0_lt_compat|]. now apply Rmult_le_compat_l. }
  specialize (W pieces (le_n _)). now replace (arrival - INR pieces * part) with 0 in W by lra.
Qed.

Theorem the_bound_within_a_container_is_tighter (goal container : region) piece pieces : 0 <= piece ->
  included (reached_within goal container piece pieces) (dilate goal (INR pieces * piece)).
Proof.
  intro P. induction pieces as [|n IH]; intros x H.
  - exists x. destruct H as [G _]. split; [exact G|]. pose proof (distance_squared x x) as D. pose proof (distance_not_negative x x). simpl. nra.
  - destruct H as [(y & Y & D) _]. destruct (IH y Y) as (z & G & E). exists z. split; [exact G|].
    pose proof (the_way_round_is_not_shorter x y z). rewrite S_INR. lra.
Qed.

(** * Pruning based on offsets: `prune_by_offset`, which is not the paper's *)

(** The heading of an angle; angles that differ little have headings that do. *)
Definition heading_at (angle : R) : heading := (cos angle, sin angle).

Lemma a_sine_is_no_larger_than_its_angle x : sin x * sin x <= x * x.
Proof.
  assert (forall y, 0 < y -> sin y * sin y <= y * y) as P.
  { intros y Y. pose proof (SIN_bound y). destruct (Rle_lt_dec 1 y) as [L|L]; [nra|].
    pose proof (sin_lt_x y Y). pose proof PI2_1. assert (0 < sin y) by (apply sin_gt_0; lra). nra. }
  destruct (Rtotal_order x 0) as [N|[->|Y]]; [|rewrite sin_0; lra|now apply P].
  pose proof (P (- x) ltac:(lra)) as Q. rewrite sin_neg in Q. nra.
Qed.

Lemma a_chord_is_no_longer_than_its_arc v a b : distance (rotate v (heading_at a)) (rotate v (heading_at b)) <= length v * Rabs (a - b).
Proof.
  assert (square (minus (rotate v (heading_at b)) (rotate v (heading_at a))) = square v * (4 * (sin ((a - b) / 2) * sin ((a - b) / 2)))) as E.
  { transitivity (square v * (2 - 2 * cos (a - b))).
    - rewrite cos_minus. pose proof (sin2_cos2 a) as A. pose proof (sin2_cos2 b) as B. unfold Rsqr in A, B.
      unfold square, minus, plus, opposite, rotate, heading_at; simpl.
      set (c := cos a) in *; set (s := sin a) in *; set (d := cos b) in *; set (t := sin b) in *.
      replace (2 - 2 * (c * d + s * t)) with ((s * s + c * c) + (t * t + d * d) - 2 * (c * d + s * t)) by (rewrite A, B; ring). ring.
    - f_equal. replace (a - b) with (2 * ((a - b) / 2)) at 1 by field. rewrite cos_2a_sin. ring. }
  unfold distance. apply Rsqr_incr_0_var.
  - unfold Rsqr. rewrite length_times_length, E. pose proof (a_sine_is_no_larger_than_its_angle ((a - b) / 2)) as S.
    replace (length v * Rabs (a - b) * (length v * Rabs (a - b))) with (square v * (Rabs (a - b) * Rabs (a - b)))
      by (rewrite <- length_times_length; ring).
    replace (Rabs (a - b) * Rabs (a - b)) with ((a - b) * (a - b)) by (unfold Rabs; destruct Rcase_abs; ring).
    apply Rmult_le_compat_l; [apply square_not_negative|]. lra.
  - apply Rmult_le_pos; [apply sqrt_pos|apply Rabs_pos].
Qed.

(** From where a point that is so far across and along, as the polygon is headed, lies within a blur of the target. *)
Definition pruned_by_offset (map : list cell) (target : region) (offsets : vector -> Prop) (blur : R) : region := fun x =>
  exists p offset y, In p map /\ fst p x /\ offsets offset /\ target y /\ distance (offset_local x (heading_at (snd p)) offset) y <= blur.

Theorem pruning_by_offset_keeps_every_position_from_which_the_offset_leads_to_the_target
  map (target : region) (offsets : vector -> Prop) delta slack farthest x angle p offset y :
  is_aligned map delta x angle p -> offsets offset -> length offset <= farthest -> target y ->
  distance (offset_local x (heading_at angle) offset) y <= slack ->
  pruned_by_offset map target offsets (slack + delta * farthest) x.
Proof.
  intros (P & Px & A) O F T D. exists p, offset, y. repeat split; try assumption.
  pose proof (the_way_round_is_not_shorter (offset_local x (heading_at (snd p)) offset) (offset_local x (heading_at angle) offset) y) as W.
  assert (distance (offset_local x (heading_at (snd p)) offset) (offset_local x (heading_at angle) offset)
    = distance (rotate offset (heading_at (snd p))) (rotate offset (heading_at angle))) as E.
  { unfold distance. f_equal. destruct x. unfold offset_local, minus, plus, opposite; simpl; f_equal; ring. }
  rewrite E in W. pose proof (a_chord_is_no_longer_than_its_arc offset (snd p) angle) as C. rewrite Rabs_minus_sym in C.
  assert (length offset * Rabs (angle - snd p) <= farthest * delta) as L.
  { apply Rmult_le_compat; [apply sqrt_pos|apply Rabs_pos|exact F|exact A]. }
  lra.
Qed.
