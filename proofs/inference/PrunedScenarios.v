(** Pruning by containment, orientation, size and reachability leaves the distribution of a scenario as it is: the algorithms of `Pruning`, which
    keep every position that meets their premises, joined with what `PrunedDistribution` says of removing what no accepted run has. The
    paper's Section "Domain-Specific Sampling Techniques": "This is sound".

    A scenario draws the position of an object from `d`, one of finitely many points of the plane, and goes on from it: `rest x` gives the
    accepted runs, with their probabilities. What an algorithm assumes of the object is a premise about these runs. The draws that are kept, `kept`,
    may be more than the points of the algorithm's region: no computer decides whether a point lies in a region just so. *)
From Coq Require Import List QArith Bool Reals Lra.
From ScenicRef Require Import kernel.Distribution scenes.Operators inference.Pruning.
From ScenicRef Require inference.PrunedDistribution.
Import ListNotations.
Local Open Scope R_scope.

Definition leaves_the_distribution_as_it_is {run} (kept : vector -> bool) (d : dist vector) (rest : vector -> dist run) : Prop :=
  same (PrunedDistribution.pruned_runs kept d rest) (PrunedDistribution.runs d rest).

(** The weights of runs are not negative. *)
Definition is_a_scenario {run} (d : dist vector) (rest : vector -> dist run) : Prop := nonnegative d /\ forall x, nonnegative (rest x).

(** Nothing of the region is removed. *)
Definition keeps (kept : vector -> bool) (r : region) : Prop := forall x, kept x = false -> ~ r x.

(** This holds of every accepted run and of its position. *)
Definition of_each_accepted_run {run} (d : dist vector) (rest : vector -> dist run) (P : vector -> run -> Prop) : Prop :=
  forall x p r w, In (x, p) d -> In (r, w) (rest x) -> (0 < w)%Q -> P x r.

Lemma mass_of_zeros A (d : dist A) : (forall a w, In (a, w) d -> w == 0)%Q -> (mass d == 0)%Q.
Proof.
  intro Z. unfold mass. induction d as [|[a w] d IH]; [reflexivity|].
  rewrite expect_cons, (Z a w) by (now left). rewrite IH by (intros b v I; apply (Z b v); now right). ring.
Qed.

Theorem a_region_that_holds_the_position_of_every_accepted_run_leaves_the_distribution_as_it_is {run}
  kept d (rest : vector -> dist run) (r : region) :
  is_a_scenario d rest -> keeps kept r -> of_each_accepted_run d rest (fun x _ => ~ ~ r x) -> leaves_the_distribution_as_it_is kept d rest.
Proof.
  intros [N R] K A. apply PrunedDistribution.pruning_what_no_accepted_run_has_leaves_the_distribution_as_it_is; [exact N|exact R|].
  intros x p I F. apply mass_of_zeros. intros b w J. specialize (R x). unfold nonnegative in R. rewrite Forall_forall in R.
  specialize (R _ J). cbn in R. destruct (Qlt_le_dec 0 w) as [L|L]; [|now apply Qle_antisym].
  exfalso. apply (A x p b w I J L). exact (K x F).
Qed.

Theorem pruning_by_containment_leaves_the_distribution_as_it_is {run} kept d (rest : vector -> dist run)
  (positions container : region) (min_radius : R) (h : run -> heading) (width length : run -> R) :
  is_a_scenario d rest -> keeps kept (fun x => positions x /\ erode container min_radius x) ->
  of_each_accepted_run d rest (fun x r =>
    positions x /\ is_heading (h r) /\ min_radius <= width r / 2 /\ min_radius <= length r / 2 /\
    included (box x (h r) (width r) (length r)) container) ->
  leaves_the_distribution_as_it_is kept d rest.
Proof.
  intros S K A. eapply a_region_that_holds_the_position_of_every_accepted_run_leaves_the_distribution_as_it_is; [exact S|exact K|].
  intros x p r w I J L. destruct (A x p r w I J L) as (P & H & W & E & C). intro F; apply F.
  eapply pruning_by_containment_keeps_every_position_of_an_object_that_is_contained; [exact H|exact W|exact E|exact P|exact C].
Qed.

Theorem pruning_by_heading_leaves_the_distribution_as_it_is {run} kept d (rest : vector -> dist run)
  map (allowed : R -> Prop) m delta delta_x delta_y (other : run -> vector) (heading_x heading_y : run -> R) :
  is_a_scenario d rest -> keeps kept (pruned_by_heading map allowed m delta) -> delta_x + delta_y <= 2 * delta ->
  of_each_accepted_run d rest (fun x r =>
    (exists p, is_aligned map delta_x x (heading_x r) p) /\ (exists q, is_aligned map delta_y (other r) (heading_y r) q) /\
    distance x (other r) <= m /\ allowed (heading_y r - heading_x r)) ->
  leaves_the_distribution_as_it_is kept d rest.
Proof.
  intros S K D A. eapply a_region_that_holds_the_position_of_every_accepted_run_leaves_the_distribution_as_it_is; [exact S|exact K|].
  intros x p r w I J L. destruct (A x p r w I J L) as ((P & AP) & (Q & AQ) & M & R). intro F; apply F.
  eapply pruning_by_heading_keeps_every_position_of_an_object_whose_relative_heading_is_allowed; eauto.
Qed.

(** Two points of the configuration are so far apart across the heading of the object's polygon. *)
Theorem pruning_by_width_leaves_the_distribution_as_it_is {run} kept d (rest : vector -> dist run) map m min_width (y z : run -> vector) :
  is_a_scenario d rest -> keeps kept (pruned_by_width map m min_width) ->
  of_each_accepted_run d rest (fun x r =>
    exists p, In p map /\ fst p x /\ (exists q, In q map /\ fst q (y r)) /\ (exists q, In q map /\ fst q (z r)) /\
    distance x (y r) <= m /\ distance x (z r) <= m /\ min_width <= Rabs (across (snd p) (y r) (z r))) ->
  leaves_the_distribution_as_it_is kept d rest.
Proof.
  intros S K A. eapply a_region_that_holds_the_position_of_every_accepted_run_leaves_the_distribution_as_it_is; [exact S|exact K|].
  intros x p r w I J L. destruct (A x p r w I J L) as (c & C & Cx & Y & Z & My & Mz & W). intro F.
  assert (~ ~ ((narrow min_width c \/ ~ narrow min_width c) /\ (fst c (y r) \/ ~ fst c (y r)))) as D by tauto.
  apply D. intros [N O]. apply F.
  exact (pruning_by_width_keeps_every_position_of_a_configuration_that_is_wide map m min_width c x (y r) (z r) N O C Cx Y Z My Mz W).
Qed.

(** The accepted runs are those of simulations here: the goal is at the end of the path, which no `require eventually` needs to say. *)
Theorem pruning_by_reachability_leaves_the_distribution_as_it_is {run} kept d (rest : vector -> dist run)
  (goal : region) speed dt time (path : run -> list vector) :
  is_a_scenario d rest -> keeps kept (dilate goal (speed * time)) -> 0 <= speed ->
  of_each_accepted_run d rest (fun x r =>
    drives speed dt x (path r) /\ INR (List.length (path r)) * dt <= time /\ goal (last (path r) x)) ->
  leaves_the_distribution_as_it_is kept d rest.
Proof.
  intros S K V A. eapply a_region_that_holds_the_position_of_every_accepted_run_leaves_the_distribution_as_it_is; [exact S|exact K|].
  intros x p r w I J L. destruct (A x p r w I J L) as (D & T & G). intro F; apply F.
  eapply pruning_by_reachability_keeps_every_start_from_which_the_goal_is_reached; eauto.
Qed.

(** With a container in which the whole path must lie: the paper's tighter bound. *)
Theorem pruning_by_reachability_within_a_container_leaves_the_distribution_as_it_is {run} kept d (rest : vector -> dist run)
  (goal container : region) speed time pieces (path : run -> R -> vector) (arrival : run -> R) :
  is_a_scenario d rest -> keeps kept (reached_within goal container (speed * time / INR pieces) pieces) -> (0 < pieces)%nat -> 0 <= speed ->
  of_each_accepted_run d rest (fun x r =>
    path r 0 = x /\ 0 <= arrival r <= time /\ moves_at_most_at speed (path r) (arrival r) /\
    (forall t, 0 <= t <= arrival r -> container (path r t)) /\ goal (path r (arrival r))) ->
  leaves_the_distribution_as_it_is kept d rest.
Proof.
  intros S K N V A. eapply a_region_that_holds_the_position_of_every_accepted_run_leaves_the_distribution_as_it_is; [exact S|exact K|].
  intros x p r w I J L. destruct (A x p r w I J L) as (<- & T & M & C & G). intro F; apply F.
  eapply pruning_by_reachability_within_a_container_keeps_every_start_from_which_the_goal_is_reached_inside; eauto.
Qed.

(** What is not in the paper. *)
Theorem pruning_by_offset_leaves_the_distribution_as_it_is {run} kept d (rest : vector -> dist run)
  map (target : region) (offsets : vector -> Prop) delta slack farthest (angle : run -> R) (offset y : run -> vector) :
  is_a_scenario d rest -> keeps kept (pruned_by_offset map target offsets (slack + delta * farthest)) ->
  of_each_accepted_run d rest (fun x r =>
    (exists p, is_aligned map delta x (angle r) p) /\ offsets (offset r) /\ Operators.length (offset r) <= farthest /\ target (y r) /\
    distance (offset_local x (heading_at (angle r)) (offset r)) (y r) <= slack) ->
  leaves_the_distribution_as_it_is kept d rest.
Proof.
  intros S K A. eapply a_region_that_holds_the_position_of_every_accepted_run_leaves_the_distribution_as_it_is; [exact S|exact K|].
  intros x p r w I J L. destruct (A x p r w I J L) as ((P & AP) & O & F & T & D). intro G; apply G.
  eapply pruning_by_offset_keeps_every_position_from_which_the_offset_leads_to_the_target; eauto.
Qed.

(** * An example *)

(** An object of 2 m by 2 m, which faces North, is at 0 or at 10 on the x axis and has to be on a road that ends at 5: all premises hold, and a position
    is removed. *)
Definition two_places : dist vector := [((0, 0), (1 # 2)%Q); ((10, 0), (1 # 2)%Q)].
Definition on_the_road (y : vector) : Prop := -5 <= fst y <= 5 /\ -5 <= snd y <= 5.
Definition before_the_end (x : vector) : bool := if Rle_dec (fst x) 4 then true else false.
Definition accepted_there (x : vector) : dist vector := if before_the_end x then ret x else Distribution.stuck.

Example the_premises_of_pruning_by_containment_can_be_met :
  leaves_the_distribution_as_it_is before_the_end two_places accepted_there /\ before_the_end (10, 0) = false.
Proof.
  split; [|unfold before_the_end; simpl; destruct Rle_dec; [lra|reflexivity]].
  apply (pruning_by_containment_leaves_the_distribution_as_it_is before_the_end two_places accepted_there (fun _ => True) on_the_road 1
    (fun _ => north) (fun _ => 2) (fun _ => 2)).
  - split; [repeat constructor; discriminate|]. intros x. unfold accepted_there. destruct (before_the_end x); [apply nonnegative_ret|constructor].
  - intros [x y] K [_ E]. unfold before_the_end in K. simpl in K. destruct Rle_dec as [|N]; [discriminate|].
    destruct (E (x + 1, y)) as [[_ F] _]; [|simpl in F; lra]. unfold distance, length, square, minus, plus, opposite; simpl.
    replace (_ + _) with (1 * 1) by ring. rewrite sqrt_square; lra.
  - intros x p r w I J _. split; [exact Logic.I|]. split; [unfold is_heading, north; simpl; ring|]. split; [lra|]. split; [lra|].
    assert (x = (0, 0)) as ->.
    { destruct I as [I|[I|[]]]; injection I as <- _; [reflexivity|]. unfold accepted_there, before_the_end in J. simpl in J.
      destruct Rle_dec; [lra|destruct J]. }
    intros y ([a b] & -> & A & B). unfold on_the_road, offset_local, rotate, plus, north. simpl in *.
    unfold Rabs in *. repeat destruct Rcase_abs; lra.
Qed.
