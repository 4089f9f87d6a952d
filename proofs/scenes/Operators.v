(** Vectors, headings and the operators on them, over the real numbers: `semantics/space/geometry.py`, `semantics/scenes/operators.py` and
    `semantics/scenes/specifiers.py`. The paper's Figure "Notation" and Section "Operators".

    A heading is given by its cosine and its sine, so that c² + s² = 1 is all that is known of it: the addition of angles is the
    multiplication of unit complex numbers, and two angles that differ by a full turn are one heading. Floating-point numbers are
    another matter: nothing is said of rounding here. *)
From Coq Require Import Reals Lra Psatz.
Local Open Scope R_scope.

Definition vector : Type := R * R.
Definition heading : Type := R * R.  (* cosine, sine *)

Definition plus (v w : vector) : vector := (fst v + fst w, snd v + snd w).
Definition opposite (v : vector) : vector := (- fst v, - snd v).
Definition minus (v w : vector) : vector := plus v (opposite w).
Definition square (v : vector) : R := fst v * fst v + snd v * snd v.
Definition length (v : vector) : R := sqrt (square v).
Definition distance (v w : vector) : R := length (minus w v).

Definition is_heading (h : heading) : Prop := fst h * fst h + snd h * snd h = 1.
Definition north : heading := (1, 0).
Definition turn (h k : heading) : heading := (fst h * fst k - snd h * snd k, snd h * fst k + fst h * snd k).
Definition back (h : heading) : heading := (fst h, - snd h).

(** rotate(⟨x, y⟩, θ) = ⟨x cos θ - y sin θ, x sin θ + y cos θ⟩. *)
Definition rotate (v : vector) (h : heading) : vector :=
  (fst v * fst h - snd v * snd h, fst v * snd h + snd v * fst h).

(** arctan in the paper: the heading of a vector that is not zero. *)
Definition heading_of (v : vector) : heading := (snd v / length v, - fst v / length v).

(** V1 offset along H by V2; offsetLocal(OP, V); beyond V1 by V2 from V3. *)
Definition offset_along (v1 : vector) (h : heading) (v2 : vector) : vector := plus v1 (rotate v2 h).
Definition offset_local (position : vector) (h : heading) (v : vector) : vector := plus position (rotate v h).
Definition beyond (v1 v2 v3 : vector) : vector := plus v1 (rotate v2 (heading_of (minus v1 v3))).

(** H1 relative to H2; relative heading of H1 from H2; distance of OP past V. *)
Definition relative_to (h1 h2 : heading) : heading := turn h1 h2.
Definition relative_heading (h1 h2 : heading) : heading := turn h1 (back h2).
Definition distance_past (position : vector) (h : heading) (v : vector) : R := snd (rotate (minus position v) (back h)).

(** apparently facing H from V, for an object at P; apparent heading of an object at P with heading K, from V. *)
Definition apparently_facing (h : heading) (p v : vector) : heading := turn h (heading_of (minus p v)).
Definition apparent_heading (p : vector) (k : heading) (v : vector) : heading := turn k (back (heading_of (minus p v))).

(** ahead of OP by S, and left of OP by S, where self is so long, or wide: its centre. *)
Definition ahead_of (position : vector) (h : heading) (self_length s : R) : vector := offset_local position h (0, self_length / 2 + s).
Definition left_of (position : vector) (h : heading) (self_width s : R) : vector := offset_local position h (- (self_width / 2) - s, 0).

Ltac coordinates := unfold distance, minus, plus, opposite, rotate, turn, back, square, north; simpl; f_equal; try ring.

(** * Rotations *)

Lemma square_of_rotated v h : is_heading h -> square (rotate v h) = square v.
Proof.
  unfold is_heading, square, rotate; destruct v as [x y], h as [c s]; simpl; intro H.
  replace (_ + _) with ((x * x + y * y) * (c * c + s * s)) by ring. rewrite H; ring.
Qed.

Lemma rotate_minus v w h : rotate (minus v w) h = minus (rotate v h) (rotate w h).
Proof. coordinates. Qed.

Theorem rotation_preserves_lengths v h : is_heading h -> length (rotate v h) = length v.
Proof. intro H; unfold length; now rewrite square_of_rotated. Qed.

Theorem rotation_preserves_distances v w h : is_heading h -> distance (rotate v h) (rotate w h) = distance v w.
Proof. intro H; unfold distance; rewrite <- rotate_minus; now apply rotation_preserves_lengths. Qed.

Theorem rotations_add_up v h k : rotate (rotate v h) k = rotate v (turn h k).
Proof. coordinates. Qed.

Theorem north_turns_nothing v : rotate v north = v.
Proof. destruct v; coordinates. Qed.

Lemma back_cancels h : is_heading h -> turn h (back h) = north.
Proof. unfold is_heading; destruct h as [c s]; simpl; intro H; coordinates. rewrite <- H; ring. Qed.

Lemma cancels_back h : is_heading h -> turn (back h) h = north.
Proof. unfold is_heading; destruct h as [c s]; simpl; intro H; coordinates. rewrite <- H; ring. Qed.

Theorem rotation_can_be_undone v h : is_heading h -> rotate (rotate v h) (back h) = v /\ rotate (rotate v (back h)) h = v.
Proof.
  intro H; rewrite !rotations_add_up, back_cancels, cancels_back by assumption; split; apply north_turns_nothing.
Qed.

Theorem headings_are_a_commutative_group h k l :
  is_heading h -> is_heading k ->
  is_heading (turn h k) /\ is_heading (back h) /\ turn h k = turn k h /\ turn (turn h k) l = turn h (turn k l) /\ turn h north = h /\ turn h (back h) = north.
Proof.
  intros Hh Hk; repeat split.
  - unfold is_heading in *; destruct h as [a b], k as [c d]; simpl in *.
    replace (_ + _) with ((a * a + b * b) * (c * c + d * d)) by ring. rewrite Hh, Hk; ring.
  - unfold is_heading in *; destruct h as [a b]; simpl in *. rewrite <- Hh; ring.
  - coordinates.
  - coordinates.
  - destruct h; coordinates.
  - now apply back_cancels.
Qed.

(** * The heading of a vector *)

Lemma square_not_negative v : 0 <= square v.
Proof. unfold square; nra. Qed.

Lemma length_times_length v : length v * length v = square v.
Proof. apply sqrt_sqrt, square_not_negative. Qed.

Lemma length_positive v : v <> (0, 0) -> 0 < length v.
Proof.
  intro N; apply sqrt_lt_R0. destruct v as [x y]; unfold square; simpl.
  destruct (Req_dec x 0) as [->|X]; [|nra].
  destruct (Req_dec y 0) as [->|Y]; [now contradict N|nra].
Qed.

Theorem the_heading_of_a_vector_turns_north_into_it v :
  v <> (0, 0) -> is_heading (heading_of v) /\ rotate (0, length v) (heading_of v) = v.
Proof.
  intro N; pose proof (length_positive v N) as P; pose proof (length_times_length v) as L.
  destruct v as [x y]; unfold is_heading, heading_of, rotate, square in *; simpl in *. set (l := length (x, y)) in *. split.
  - replace (_ + _) with ((x * x + y * y) / (l * l)) by (field; lra). rewrite <- L; field; lra.
  - f_equal; field; lra.
Qed.

Theorem no_other_heading_does v h : v <> (0, 0) -> rotate (0, length v) h = v -> h = heading_of v.
Proof.
  intros N E; pose proof (length_positive v N) as P; destruct v as [x y], h as [c s].
  unfold rotate, heading_of in *; simpl in *; set (l := length (x, y)) in *; injection E as X Y.
  f_equal; apply (Rmult_eq_reg_r l); try lra; unfold Rdiv; rewrite Rmult_assoc, Rinv_l by lra; lra.
Qed.

(** * Offsets *)

Lemma plus_minus v w : minus (plus v w) v = w.
Proof. destruct v, w; coordinates. Qed.

Theorem an_offset_is_as_far_as_it_says v h w : is_heading h -> distance v (offset_along v h w) = length w.
Proof. intro H; unfold distance, offset_along; rewrite plus_minus; now apply rotation_preserves_lengths. Qed.

Theorem an_offset_can_be_read_back v h w : is_heading h -> rotate (minus (offset_along v h w) v) (back h) = w.
Proof. intro H; unfold offset_along; rewrite plus_minus; now apply rotation_can_be_undone. Qed.

Theorem an_offset_can_be_taken_back v h w : offset_along (offset_along v h w) h (opposite w) = v.
Proof. destruct v, w; unfold offset_along; coordinates. Qed.

Theorem offsets_along_one_heading_add_up v h w u : offset_along (offset_along v h w) h u = offset_along v h (plus w u).
Proof. unfold offset_along; coordinates. Qed.

Theorem the_distance_past_is_the_forward_part_of_the_offset v h w : is_heading h -> distance_past (offset_along v h w) h v = snd w.
Proof. intro H; unfold distance_past; now rewrite an_offset_can_be_read_back. Qed.

Theorem an_object_ahead_leaves_the_gap_behind_it position h self_length s :
  offset_local (ahead_of position h self_length s) h (0, - (self_length / 2)) = offset_local position h (0, s).
Proof. unfold ahead_of, offset_local; coordinates. Qed.

Theorem an_object_to_the_left_leaves_the_gap_at_its_right position h self_width s :
  offset_local (left_of position h self_width s) h (self_width / 2, 0) = offset_local position h (- s, 0).
Proof. unfold left_of, offset_local; coordinates; field. Qed.

Theorem a_local_offset_is_one_along_the_heading position h v : offset_local position h v = offset_along position h v.
Proof. reflexivity. Qed.

(** * beyond *)

Lemma minus_zero v w : v <> w -> minus v w <> (0, 0).
Proof.
  intros N E; apply N; destruct v as [a b], w as [c d]; unfold minus, plus, opposite in E; simpl in E. injection E as X Y. f_equal; lra.
Qed.

Theorem what_lies_beyond_is_as_far_from_the_point_as_it_says v1 v2 v3 : v1 <> v3 -> distance v1 (beyond v1 v2 v3) = length v2.
Proof.
  intro N; unfold distance, beyond; rewrite plus_minus.
  now apply rotation_preserves_lengths, the_heading_of_a_vector_turns_north_into_it, minus_zero.
Qed.

Theorem the_offset_beyond_can_be_read_back v1 v2 v3 :
  v1 <> v3 -> rotate (minus (beyond v1 v2 v3) v1) (back (heading_of (minus v1 v3))) = v2.
Proof.
  intro N; unfold beyond; rewrite plus_minus.
  now apply rotation_can_be_undone, the_heading_of_a_vector_turns_north_into_it, minus_zero.
Qed.

Lemma rotate_plus v w h : rotate (plus v w) h = plus (rotate v h) (rotate w h).
Proof. coordinates. Qed.

(** "treating O as an offset in the local coordinate system at A oriented along the line of sight from B": (0, d) is d metres further away. *)
Theorem straight_beyond_is_on_the_line_of_sight_and_so_much_further v1 v3 d :
  v1 <> v3 -> 0 <= d ->
  distance v3 (beyond v1 (0, d) v3) = distance v3 v1 + d /\
  beyond v1 (0, d) v3 = plus v3 (rotate (0, distance v3 v1 + d) (heading_of (minus v1 v3))).
Proof.
  intros N D; pose proof (minus_zero _ _ N) as Z.
  destruct (the_heading_of_a_vector_turns_north_into_it _ Z) as [H E].
  assert (beyond v1 (0, d) v3 = plus v3 (rotate (0, distance v3 v1 + d) (heading_of (minus v1 v3)))) as B.
  { unfold distance. replace (0, length (minus v1 v3) + d) with (plus (0, length (minus v1 v3)) (0, d)) by (unfold plus; simpl; f_equal; ring).
    rewrite rotate_plus, E. unfold beyond. destruct v1, v3; coordinates. }
  split; [|exact B]. rewrite B at 1. unfold distance at 1. rewrite plus_minus, rotation_preserves_lengths by exact H.
  unfold length at 1, square; simpl. replace (0 * 0 + _) with (Rsqr (distance v3 v1 + d)) by (unfold Rsqr; ring).
  apply sqrt_Rsqr. unfold distance, length. pose proof (sqrt_pos (square (minus v1 v3))). lra.
Qed.

(** * Headings *)

Theorem an_object_apparently_faces_what_it_was_told h p v : p <> v -> apparent_heading p (apparently_facing h p v) v = h.
Proof.
  intro N; unfold apparent_heading, apparently_facing.
  destruct (the_heading_of_a_vector_turns_north_into_it _ (minus_zero _ _ N)) as [H _].
  transitivity (turn h (turn (heading_of (minus p v)) (back (heading_of (minus p v))))); [coordinates|].
  rewrite back_cancels by exact H. destruct h; coordinates.
Qed.

Theorem a_relative_heading_is_what_was_added h k : is_heading k -> relative_heading (relative_to h k) k = h.
Proof.
  intro H; unfold relative_heading, relative_to. transitivity (turn h (turn k (back k))); [coordinates|].
  rewrite back_cancels by exact H. destruct h; coordinates.
Qed.
