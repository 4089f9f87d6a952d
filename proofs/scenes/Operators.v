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

(** behind OP by S, and right of OP by S. *)
Definition behind_of (position : vector) (h : heading) (self_length s : R) : vector := offset_local position h (0, - (self_length / 2) - s).
Definition right_of (position : vector) (h : heading) (self_width s : R) : vector := offset_local position h (self_width / 2 + s, 0).

(** front of O is (0, 1) of its box, back of O (0, -1), left of O (-1, 0), right of O (1, 0), front left of O (-1, 1), and so on. *)
Definition of_box (position : vector) (h : heading) (wide long i j : R) : vector := offset_local position h (i * (wide / 2), j * (long / 2)).

(** facing toward V and facing away from V, for an object at P. *)
Definition facing_toward (v p : vector) : heading := heading_of (minus v p).
Definition facing_away_from (v p : vector) : heading := heading_of (minus p v).

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

Theorem an_object_behind_leaves_the_gap_ahead_of_it position h self_length s :
  offset_local (behind_of position h self_length s) h (0, self_length / 2) = offset_local position h (0, - s).
Proof. unfold behind_of, offset_local; coordinates; field. Qed.

Theorem an_object_to_the_right_leaves_the_gap_at_its_left position h self_width s :
  offset_local (right_of position h self_width s) h (- (self_width / 2), 0) = offset_local position h (s, 0).
Proof. unfold right_of, offset_local; coordinates. Qed.

Theorem a_local_offset_is_one_along_the_heading position h v : offset_local position h v = offset_along position h v.
Proof. reflexivity. Qed.

Lemma length_of_straight s : 0 <= s -> length (s, 0) = s /\ length (- s, 0) = s /\ length (0, s) = s /\ length (0, - s) = s.
Proof.
  intro S; unfold length, square; simpl.
  repeat split; (replace (_ + _) with (s * s) by ring); now apply sqrt_square.
Qed.

(** left of O by S, where O is so wide: left of (left of O) by S, and so on. The middles of the sides that face each other are S apart. *)
Theorem an_object_beside_another_is_as_far_from_it_as_it_says p h wide long self_width self_length s : is_heading h -> 0 <= s ->
  distance (of_box p h wide long (-1) 0) (of_box (left_of (of_box p h wide long (-1) 0) h self_width s) h self_width self_length 1 0) = s /\
  distance (of_box p h wide long 1 0) (of_box (right_of (of_box p h wide long 1 0) h self_width s) h self_width self_length (-1) 0) = s /\
  distance (of_box p h wide long 0 1) (of_box (ahead_of (of_box p h wide long 0 1) h self_length s) h self_width self_length 0 (-1)) = s /\
  distance (of_box p h wide long 0 (-1)) (of_box (behind_of (of_box p h wide long 0 (-1)) h self_length s) h self_width self_length 0 1) = s.
Proof.
  intros H S. destruct (length_of_straight s S) as (A & B & C & D).
  assert (forall v w, length w = s -> distance v (offset_local v h w) = s) as E
    by (intros v w L; rewrite <- L; now apply an_offset_is_as_far_as_it_says).
  repeat split.
  - rewrite <- (E (of_box p h wide long (-1) 0) (- s, 0) B) at 2. f_equal.
    rewrite <- (an_object_to_the_left_leaves_the_gap_at_its_right _ h self_width s). unfold of_box. do 2 f_equal; field.
  - rewrite <- (E (of_box p h wide long 1 0) (s, 0) A) at 2. f_equal.
    rewrite <- (an_object_to_the_right_leaves_the_gap_at_its_left _ h self_width s). unfold of_box. do 2 f_equal; field.
  - rewrite <- (E (of_box p h wide long 0 1) (0, s) C) at 2. f_equal.
    rewrite <- (an_object_ahead_leaves_the_gap_behind_it _ h self_length s). unfold of_box. do 2 f_equal; field.
  - rewrite <- (E (of_box p h wide long 0 (-1)) (0, - s) D) at 2. f_equal.
    rewrite <- (an_object_behind_leaves_the_gap_ahead_of_it _ h self_length s). unfold of_box. do 2 f_equal; field.
Qed.

Theorem sides_are_half_the_size_away_and_corners_half_the_diagonal p h width len i j : is_heading h -> 0 <= width -> 0 <= len ->
  (i * i = 1 -> distance p (of_box p h width len i 0) = width / 2) /\
  (j * j = 1 -> distance p (of_box p h width len 0 j) = len / 2) /\
  (i * i = 1 -> j * j = 1 -> distance p (of_box p h width len i j) = length (width, len) / 2).
Proof.
  intros H W L. unfold of_box, offset_local. fold (offset_along p h).
  assert (forall v x, 0 <= x -> square v = x * x -> distance p (offset_along p h v) = x) as E.
  { intros v x X S. rewrite an_offset_is_as_far_as_it_says by exact H. unfold length. rewrite S. now apply sqrt_square. }
  change (plus p (rotate ?v h)) with (offset_along p h v).
  repeat split; intros; apply E; unfold square; simpl; try lra.
  - nra.
  - nra.
  - pose proof (sqrt_pos (square (width, len))). unfold length. lra.
  - pose proof (length_times_length (width, len)) as M. unfold square in M; simpl in M. nra.
Qed.

(** relative position of V1 from V2; V1 offset by V2. *)
Theorem a_relative_position_is_what_leads_there v1 v2 : plus v2 (minus v1 v2) = v1 /\ minus (plus v1 v2) v1 = v2 /\ plus v1 v2 = plus v2 v1.
Proof. destruct v1, v2; repeat split; coordinates. Qed.

(** * Distances *)

Lemma distance_squared v w : distance v w * distance v w = (fst w - fst v) * (fst w - fst v) + (snd w - snd v) * (snd w - snd v).
Proof. unfold distance; rewrite length_times_length; unfold square, minus, plus, opposite; simpl; ring. Qed.

Lemma distance_not_negative v w : 0 <= distance v w.
Proof. apply sqrt_pos. Qed.

Theorem the_way_round_is_not_shorter u v w : distance u w <= distance u v + distance v w.
Proof.
  pose proof (distance_squared u v) as A; pose proof (distance_squared v w) as B; pose proof (distance_squared u w) as C.
  pose proof (distance_not_negative u v); pose proof (distance_not_negative v w); pose proof (distance_not_negative u w).
  set (a := distance u v) in *; set (b := distance v w) in *; set (c := distance u w) in *.
  set (p := fst v - fst u) in *; set (q := snd v - snd u) in *; set (r := fst w - fst v) in *; set (s := snd w - snd v) in *.
  assert (fst w - fst u = p + r) as E by (unfold p, r; ring). assert (snd w - snd u = q + s) as F by (unfold q, s; ring).
  rewrite E, F in C. assert (p * r + q * s <= a * b) as D.
  { apply Rsqr_incr_0_var; [|now apply Rmult_le_pos]. unfold Rsqr. replace (a * b * (a * b)) with ((a * a) * (b * b)) by ring.
    rewrite A, B. pose proof (Rle_0_sqr (p * s - q * r)) as S; unfold Rsqr in S. nra. }
  apply Rsqr_incr_0_var; [|lra]. unfold Rsqr. nra.
Qed.

Theorem distances_are_the_same_both_ways_and_0_only_from_a_point_to_itself v w :
  distance v w = distance w v /\ (distance v w = 0 <-> v = w).
Proof.
  assert (distance v w = distance w v) as S.
  { unfold distance, length. f_equal. destruct v, w; unfold square, minus, plus, opposite; simpl; ring. }
  split; [exact S|]. pose proof (distance_squared v w) as D. split.
  - intro Z. rewrite Z, Rmult_0_l in D. destruct v as [a b], w as [c e]; cbn [fst snd] in D.
    destruct (Rplus_sqr_eq_0 (c - a) (e - b)) as [X Y]; [unfold Rsqr; lra|]. f_equal; lra.
  - intros <-. apply Rsqr_0_uniq. unfold Rsqr. rewrite D. ring.
Qed.

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

Theorem what_faces_toward_a_point_has_it_straight_ahead v p : p <> v -> offset_local p (facing_toward v p) (0, distance p v) = v.
Proof.
  intro N; unfold facing_toward, distance, offset_local.
  destruct (the_heading_of_a_vector_turns_north_into_it _ (minus_zero v p (not_eq_sym N))) as [_ ->]. destruct v, p; coordinates.
Qed.

Theorem what_faces_away_from_a_point_has_it_straight_behind v p : p <> v -> offset_local p (facing_away_from v p) (0, - distance v p) = v.
Proof.
  intro N; unfold facing_away_from, distance, offset_local.
  destruct (the_heading_of_a_vector_turns_north_into_it _ (minus_zero p v N)) as [_ E].
  replace (rotate (0, - length (minus p v)) (heading_of (minus p v))) with (opposite (rotate (0, length (minus p v)) (heading_of (minus p v))))
    by (unfold opposite, rotate; simpl; f_equal; ring).
  rewrite E. destruct v, p; coordinates.
Qed.
