(** Soft requirements: what `require[p] B` makes of the probability of B (semantics/scenes/statements.py,
    inference/enumeration.py).

    The rule "Soft Requirements" (the paper, figure "Semantics of statements") goes on with
    `require B` with probability p, and with `pass` otherwise; runs that get stuck are
    discarded and the others renormalised ("Semantics of a Scenic Program"). Section 5.1
    claims that B then holds with probability at least p. Under the rule it does not; if the
    coins are thrown once per scene, before the rejection loop, it does, provided that the
    requirements can all be met. The two readings of `soft` (scenic-ref readings soft):

    - [under_run]    a coin in every run, as the rule has it;
    - [under_scene]  one coin for every scene: all attempts at it see the same coins.

    A program is here the distribution of its draws, without those runs that violate a hard
    requirement, and the list of its soft requirements. *)
From Coq Require Import Setoid Morphisms Lqa Bool.
From ScenicRef Require Import kernel.Distribution.
Import ListNotations.
Open Scope Q_scope.

(** `require[p] B`: the pair of p and B. *)
Definition soft (A : Type) : Type := Q * (A -> bool).

Section Readings.
Context {A : Type}.
Implicit Types (prior : dist A) (rs : list (soft A)) (B : A -> bool) (p : Q).

Definition require (b : bool) : dist unit := if b then ret tt else stuck.

(** `statements.soft_requirement`: one draw of the run, then `check` or `skip`. *)
Definition require_soft (a : A) (r : soft A) : dist unit :=
  bind (coin (fst r)) (fun heads => if heads then require (snd r a) else ret tt).

Fixpoint require_all (a : A) rs : dist unit :=
  match rs with
  | [] => ret tt
  | r :: rs => bind (require_soft a r) (fun _ => require_all a rs)
  end.

(** What a run gives, unless it gets stuck. *)
Definition attempt prior rs : dist A :=
  bind prior (fun a => bind (require_all a rs) (fun _ => ret a)).

Definition under_run prior rs : dist A := normalised (attempt prior rs).

(** Under the other reading the coins say, for a whole scene, which conditions are demanded. *)
Fixpoint throw rs : dist (list (A -> bool)) :=
  match rs with
  | [] => ret []
  | (p, B) :: rs =>
      bind (coin p) (fun heads =>
      bind (throw rs) (fun demanded => ret (if heads then B :: demanded else demanded)))
  end.

Definition meets (demanded : list (A -> bool)) (a : A) : bool :=
  forallb (fun B => B a) demanded.

(** The rejection loop of one scene. Where no run is accepted there is no scene, and nothing
    is left ([what_has_no_mass_has_none_when_normalised]). *)
Definition loop prior demanded : dist A := normalised (given (meets demanded) prior).

(** `enumeration.summed`: each result of the coins has a rejection loop, and a normalisation,
    of its own; results under which no run is accepted are left out. *)
Definition per_scene prior rs : dist A := bind (throw rs) (loop prior).
Definition under_scene prior rs : dist A := normalised (per_scene prior rs).

(** ** Under `run`: the general law *)

(** The probability that the coins of all violated requirements show tails: the product of
    1 - p over them (the weight of a run in inference/importance.py). *)
Fixpoint survival rs (a : A) : Q :=
  match rs with
  | [] => 1
  | (p, B) :: rs => (if B a then 1 else 1 - p) * survival rs a
  end.

Lemma mass_of_require_soft a p B : mass (require_soft a (p, B)) == if B a then 1 else 1 - p.
Proof.
  unfold require_soft. rewrite mass_of_bind, expect_coin. cbn [fst snd].
  unfold require. destruct (B a); rewrite ?mass_ret; unfold mass; rewrite ?expect_stuck; ring.
Qed.

Theorem a_run_survives_with_the_product_over_violated_requirements a rs :
  mass (require_all a rs) == survival rs a.
Proof.
  induction rs as [|[p B] rs IH]; [reflexivity|].
  cbn [require_all survival]. rewrite mass_of_bind, expect_constant, IH, mass_of_require_soft.
  ring.
Qed.

(** For every function [f] of the outcome; the next theorem reads it for one outcome. *)
Theorem accepted_expectation_weighs_by_survival prior rs f :
  expect f (attempt prior rs) == expect (fun a => survival rs a * f a) prior.
Proof.
  unfold attempt. rewrite expect_bind. apply expect_ext. intros a.
  rewrite expect_bind, (expect_ext _ _ (fun _ => f a)) by (intros []; apply expect_ret).
  rewrite expect_constant, a_run_survives_with_the_product_over_violated_requirements. ring.
Qed.

Theorem accepted_mass_of_an_outcome_is_prior_times_survival prior rs (is_a : A -> bool) a :
  (forall b, is_a b = true <-> b = a) ->
  pr is_a (attempt prior rs) == pr is_a prior * survival rs a.
Proof.
  intros H. unfold pr. rewrite accepted_expectation_weighs_by_survival.
  rewrite <- expect_times_right. apply expect_ext. intros b.
  destruct (is_a b) eqn:E; cbn; [|ring]. apply H in E as ->. ring.
Qed.

(** Counting the coins instead of throwing them (inference/importance.py): the weighted mean
    over the runs of the prior is the expectation under `run`. *)
Theorem weighing_by_survival_gives_the_law_under_run prior rs f :
  expect f (under_run prior rs)
  == expect (fun a => survival rs a * f a) prior / expect (survival rs) prior.
Proof.
  unfold under_run. rewrite expect_normalised. unfold mass.
  rewrite !accepted_expectation_weighs_by_survival.
  assert (expect (fun a => survival rs a * 1) prior == expect (survival rs) prior) as ->
    by (apply expect_ext; intros; ring).
  reflexivity.
Qed.

(** A soft requirement that is demanded with probability 1 is a hard one. *)
Theorem demanded_with_probability_1_is_hard prior rs B :
  attempt prior ((1, B) :: rs) ≈ attempt (given B prior) rs.
Proof.
  intros f. rewrite !accepted_expectation_weighs_by_survival, expect_given.
  apply expect_ext. intros a. cbn [survival]. destruct (B a); cbn [indicator]; ring.
Qed.

Theorem demanded_with_probability_0_is_no_requirement prior rs B :
  attempt prior ((0, B) :: rs) ≈ attempt prior rs.
Proof.
  intros f. rewrite !accepted_expectation_weighs_by_survival.
  apply expect_ext. intros a. cbn [survival]. destruct (B a); ring.
Qed.

(** The readings differ in nothing but where one normalises: outside the throw of the coins,
    or within it as well. *)
Lemma throw_decides p B rs f :
  expect f (throw ((p, B) :: rs))
  == p * expect (fun demanded => f (B :: demanded)) (throw rs) + (1 - p) * expect f (throw rs).
Proof.
  cbn [throw]. rewrite expect_bind, expect_coin, !expect_bind.
  apply Qplus_comp; (apply Qmult_comp; [reflexivity|]);
    apply expect_ext; intros; apply expect_ret.
Qed.

Theorem run_throws_first_and_normalises_at_the_end prior rs :
  under_run prior rs
  ≈ normalised (bind (throw rs) (fun demanded => given (meets demanded) prior)).
Proof.
  unfold under_run. apply normalised_respects. intros f.
  rewrite accepted_expectation_weighs_by_survival, expect_bind.
  transitivity (expect (fun a => expect (fun bs => indicator (meets bs a) * f a) (throw rs)) prior).
  - apply expect_ext. intros a. rewrite expect_times_right.
    apply Qmult_comp; [|reflexivity].
    induction rs as [|[p B] rs IH]; [cbn [throw]; now rewrite expect_ret|].
    rewrite throw_decides, <- IH. cbn [survival meets forallb].
    destruct (B a); cbn [andb].
    + fold (meets) in IH |- *. rewrite <- IH. ring.
    + cbn [indicator]. rewrite expect_zero. ring.
  - rewrite expect_swap. apply expect_ext. intros bs. now rewrite expect_given.
Qed.

(** ** Under `run`: one requirement *)

(** The prior probability of [B], given the hard requirements. *)
Definition probability B prior : Q := pr B prior / mass prior.

Lemma probability_is_between_0_and_1 B prior :
  nonnegative prior -> 0 < mass prior -> 0 <= probability B prior <= 1.
Proof.
  intros N M. pose proof (pr_nonnegative _ B prior N). pose proof (pr_at_most_mass _ B prior N).
  unfold probability. split.
  - now apply Qle_shift_div_l; [|lra].
  - apply Qle_shift_div_r; [trivial|lra].
Qed.

Lemma pr_is_a_part B prior : 0 < mass prior -> pr B prior == probability B prior * mass prior.
Proof. intros M. unfold probability. field. lra. Qed.

Lemma mass_of_attempt prior p B :
  mass (attempt prior [(p, B)]) == (1 - p) * mass prior + p * pr B prior.
Proof.
  unfold mass at 1. rewrite accepted_expectation_weighs_by_survival.
  unfold pr. rewrite <- expect_times, <- expect_constant, <- expect_plus.
  apply expect_ext. intros a. cbn [survival]. destruct (B a); cbn [indicator]; ring.
Qed.

Lemma pr_of_attempt prior p B : pr B (attempt prior [(p, B)]) == pr B prior.
Proof.
  unfold pr. rewrite accepted_expectation_weighs_by_survival.
  apply expect_ext. intros a. cbn [survival]. destruct (B a); cbn [indicator]; ring.
Qed.

(** The part of the runs that is accepted, of those that meet the hard requirements. *)
Theorem the_part_of_the_runs_that_is_accepted_under_run_is_1_minus_p_plus_p_q prior p B (q := probability B prior) :
  0 < mass prior -> mass (attempt prior [(p, B)]) / mass prior == 1 - p + p * q.
Proof.
  intros M. rewrite mass_of_attempt, pr_is_a_part by trivial. subst q. field. lra.
Qed.

Theorem probability_under_run_is_q_over_1_minus_p_plus_p_q
    prior p B (q := probability B prior) :
  0 < mass prior -> ~ 1 - p + p * q == 0 ->
  pr B (under_run prior [(p, B)]) == q / (1 - p + p * q).
Proof.
  intros M D. unfold under_run. rewrite pr_normalised, pr_of_attempt, mass_of_attempt.
  rewrite pr_is_a_part by trivial. fold q.
  transitivity (q * mass prior / ((1 - p + p * q) * mass prior)).
  - apply Qmult_comp; [reflexivity|]. apply Qinv_comp. ring.
  - set (accepted := 1 - p + p * q) in *. field. split; [trivial|lra].
Qed.

(** Both edges: no run at all is accepted only if what never holds is demanded for certain. *)
Theorem no_run_is_accepted_iff_p_is_1_and_q_is_0 prior p B (q := probability B prior) :
  nonnegative prior -> 0 < mass prior -> 0 <= p <= 1 ->
  mass (attempt prior [(p, B)]) == 0 <-> p == 1 /\ q == 0.
Proof.
  intros N M P. pose proof (probability_is_between_0_and_1 B prior N M) as R. fold q in R.
  rewrite mass_of_attempt, pr_is_a_part by trivial. fold q. split.
  - intros Z. assert ((1 - p + p * q) * mass prior == 0) as W by lra.
    apply Qmult_integral in W as [W|W]; [|lra].
    assert (p == 1) by nra. split; [trivial|]. nra.
  - intros [-> ->]. ring.
Qed.

Lemma accepted_part_is_positive p q :
  0 <= p <= 1 -> 0 <= q <= 1 -> (~ p == 1 \/ 0 < q) -> 0 < 1 - p + p * q.
Proof. intros P R [H|H]; [|nra]. assert (p < 1) by (destruct (Qlt_le_dec p 1); lra). nra. Qed.

Lemma quotient_is_below a b c : 0 < c -> a / c < b <-> a < b * c.
Proof.
  intros C. split; [|now apply Qlt_shift_div_r]. intros L.
  apply (Qmult_lt_r _ _ c) in L; [|trivial].
  assert (a / c * c == a) as E by (field; lra). now rewrite E in L.
Qed.

Lemma is_below_quotient a b c : 0 < c -> b < a / c <-> b * c < a.
Proof.
  intros C. split; [|now apply Qlt_shift_div_l]. intros L.
  apply (Qmult_lt_r _ _ c) in L; [|trivial].
  assert (a / c * c == a) as E by (field; lra). now rewrite E in L.
Qed.

(** The exact condition. With p = 1 the requirement is hard, and holds; with p = 0 nothing is
    demanded; in between it falls short for q below p/(1+p), so never if q is 1/2 or more. *)
Theorem probability_under_run_is_below_p_iff_q_is_below_p_over_1_plus_p
    prior p B (q := probability B prior) :
  nonnegative prior -> 0 < mass prior -> 0 <= p <= 1 -> (~ p == 1 \/ 0 < q) ->
  pr B (under_run prior [(p, B)]) < p <-> p < 1 /\ q < p / (1 + p).
Proof.
  intros N M P H. pose proof (probability_is_between_0_and_1 B prior N M) as R. fold q in R.
  pose proof (accepted_part_is_positive p q P R H) as D.
  rewrite probability_under_run_is_q_over_1_minus_p_plus_p_q by (trivial; fold q; lra). fold q.
  clearbody q. rewrite quotient_is_below by trivial.
  assert (p * (1 - p + p * q) - q == (1 - p) * (p - q * (1 + p))) as E by ring.
  set (t := p - q * (1 + p)) in E. split.
  - intros L. assert (p < 1).
    { destruct (Qlt_le_dec p 1) as [|G]; [trivial|]. assert (1 - p == 0) as Z by lra.
      rewrite Z in E, L. lra. }
    split; [trivial|]. apply is_below_quotient; [lra|].
    assert (0 < t) by nra. subst t. lra.
  - intros [P1 L]. apply is_below_quotient in L; [|lra].
    assert (0 < t) by (subst t; lra). nra.
Qed.

(** A soft requirement never makes its condition less likely, though. *)
Theorem probability_under_run_is_at_least_q prior p B (q := probability B prior) :
  nonnegative prior -> 0 < mass prior -> 0 <= p <= 1 -> (~ p == 1 \/ 0 < q) ->
  q <= pr B (under_run prior [(p, B)]).
Proof.
  intros N M P H. pose proof (probability_is_between_0_and_1 B prior N M) as R. fold q in R.
  pose proof (accepted_part_is_positive p q P R H) as D.
  rewrite probability_under_run_is_q_over_1_minus_p_plus_p_q by (trivial; fold q; lra). fold q.
  clearbody q. apply Qle_shift_div_l; [trivial|].
  assert (0 <= p * (1 - q) * q) by (repeat apply Qmult_le_0_compat; lra). lra.
Qed.

(** ** Under `scene`: one requirement *)

Lemma expect_per_scene_cons p B rs prior f :
  expect f (per_scene prior ((p, B) :: rs))
  == p * expect f (per_scene (given B prior) rs) + (1 - p) * expect f (per_scene prior rs).
Proof.
  unfold per_scene. rewrite expect_bind, throw_decides, !expect_bind.
  apply Qplus_comp; [|reflexivity]. apply Qmult_comp; [reflexivity|].
  apply expect_ext. intros demanded. unfold loop. apply normalised_respects.
  intros g. rewrite !expect_given. apply expect_ext. intros a.
  cbn [meets forallb]. fold (meets demanded a).
  destruct (B a), (meets demanded a); cbn; ring.
Qed.

Lemma expect_per_scene_nil prior f :
  expect f (per_scene prior []) == expect f prior / mass prior.
Proof.
  unfold per_scene, loop. cbn [throw]. rewrite expect_bind, expect_ret, expect_normalised.
  rewrite mass_given, expect_given. unfold pr, mass.
  assert (expect (fun a => indicator (meets [] a) * f a) prior == expect f prior) as ->
    by (apply expect_ext; intros; cbn; ring).
  reflexivity.
Qed.

(** [meets_all rs]: all conditions hold, whatever the coins show. *)
Definition meets_all rs : A -> bool := meets (map snd rs).

Lemma possible_given prior p B rs :
  0 < pr (meets_all ((p, B) :: rs)) prior -> 0 < pr (meets_all rs) (given B prior).
Proof. now rewrite pr_given. Qed.

Lemma possible_without prior r rs :
  nonnegative prior -> 0 < pr (meets_all (r :: rs)) prior -> 0 < pr (meets_all rs) prior.
Proof.
  intros N H. eapply Qlt_le_trans; [exact H|]. apply pr_monotone; [trivial|].
  intros a. unfold meets_all. cbn. now intros [_ T]%andb_prop.
Qed.

(** If the requirements can all be met, every result of the coins has scenes. *)
Theorem each_result_of_the_coins_gives_scenes_if_all_can_be_met prior rs :
  nonnegative prior -> 0 < pr (meets_all rs) prior -> mass (per_scene prior rs) == 1.
Proof.
  revert prior. induction rs as [|[p B] rs IH]; intros prior N H; unfold mass.
  - rewrite expect_per_scene_nil. unfold mass at 1. apply Qmult_inv_r.
    unfold meets_all, meets in H. cbn in H. change (0 < mass prior) in H. unfold mass in H. lra.
  - rewrite expect_per_scene_cons. fold (mass (per_scene (given B prior) rs)).
    fold (mass (per_scene prior rs)).
    rewrite (IH (given B prior)), (IH prior).
    + ring.
    + trivial.
    + now apply possible_without in H.
    + now apply nonnegative_given.
    + now apply possible_given in H.
Qed.

(** What holds of all outcomes of the prior holds of all scenes. *)
Lemma what_is_given_holds prior rs B :
  pr B (per_scene (given B prior) rs) == mass (per_scene (given B prior) rs).
Proof.
  unfold per_scene, pr, mass. rewrite !expect_bind. apply expect_ext. intros demanded.
  unfold loop. rewrite !expect_normalised. apply Qmult_comp; [|reflexivity].
  rewrite !expect_given. apply expect_ext. intros a. destruct (B a); cbn; ring.
Qed.

Lemma under_scene_without_loss prior rs :
  nonnegative prior -> 0 < pr (meets_all rs) prior -> under_scene prior rs ≈ per_scene prior rs.
Proof.
  intros N H. apply what_has_mass_1_stays_the_same_when_normalised.
  now apply each_result_of_the_coins_gives_scenes_if_all_can_be_met.
Qed.

(** The general law, of any requirement among several that can all be met: it holds with
    probability p, and beyond that as often as it would by itself. *)
Theorem each_of_several_requirements_holds_under_scene_with_p_and_beyond_that_as_often_as_without_it prior rs p B rs' :
  nonnegative prior -> 0 < pr (meets_all (rs ++ (p, B) :: rs')) prior ->
  pr B (under_scene prior (rs ++ (p, B) :: rs'))
  == p + (1 - p) * pr B (under_scene prior (rs ++ rs')).
Proof.
  intros N H. assert (0 < pr (meets_all (rs ++ rs')) prior) as H'.
  { eapply Qlt_le_trans; [exact H|]. apply pr_monotone; [trivial|]. intros a.
    unfold meets_all, meets. rewrite !map_app, !forallb_app. cbn.
    now intros [-> [_ ->]%andb_prop]%andb_prop. }
  rewrite !under_scene_without_loss by trivial.
  unfold pr. revert prior N H H'. induction rs as [|[p' B'] rs IH]; intros prior N H H'.
  - cbn [app] in *. rewrite expect_per_scene_cons.
    fold (pr B (per_scene (given B prior) rs')). rewrite what_is_given_holds.
    rewrite each_result_of_the_coins_gives_scenes_if_all_can_be_met; [ring| |].
    + now apply nonnegative_given.
    + now apply possible_given in H.
  - cbn [app] in *. rewrite !expect_per_scene_cons, (IH (given B' prior)), (IH prior); trivial.
    + ring.
    + now apply possible_without in H.
    + now apply possible_without in H'.
    + now apply nonnegative_given.
    + now apply possible_given in H.
    + now apply possible_given in H'.
Qed.

Lemma nonnegative_throw rs : Forall (fun r => 0 <= fst r <= 1) rs -> nonnegative (throw rs).
Proof.
  intros F. induction F as [|[p B] rs P F IH]; [apply nonnegative_ret|]. cbn [throw].
  apply nonnegative_bind; [now apply nonnegative_coin|]. intros heads.
  apply nonnegative_bind; [trivial|]. intros demanded. apply nonnegative_ret.
Qed.

Lemma pr_under_scene_is_between_0_and_1 prior rs B :
  nonnegative prior -> Forall (fun r => 0 <= fst r <= 1) rs -> 0 < pr (meets_all rs) prior ->
  0 <= pr B (under_scene prior rs) <= 1.
Proof.
  intros N F H. rewrite under_scene_without_loss by trivial.
  rewrite <- (each_result_of_the_coins_gives_scenes_if_all_can_be_met prior rs N H).
  assert (nonnegative (per_scene prior rs)) as W; [|split].
  - clear H. unfold per_scene. apply nonnegative_bind.
    + now apply nonnegative_throw.
    + intros demanded. apply nonnegative_scale; [|now apply nonnegative_given].
      apply Qinv_le_0_compat, mass_nonnegative. now apply nonnegative_given.
  - now apply pr_nonnegative.
  - now apply pr_at_most_mass.
Qed.

(** The claim of Section 5.1, for each of several requirements that can all be met. *)
Theorem each_requirement_holds_with_at_least_its_probability_under_scene prior rs p B rs' :
  nonnegative prior -> Forall (fun r => 0 <= fst r <= 1) (rs ++ (p, B) :: rs') ->
  0 < pr (meets_all (rs ++ (p, B) :: rs')) prior ->
  p <= pr B (under_scene prior (rs ++ (p, B) :: rs')).
Proof.
  intros N F H. rewrite each_of_several_requirements_holds_under_scene_with_p_and_beyond_that_as_often_as_without_it by trivial.
  apply Forall_app in F as [F F']. inversion_clear F' as [|? ? P F'']. cbn in P.
  enough (0 <= pr B (under_scene prior (rs ++ rs')) <= 1) by nra.
  apply pr_under_scene_is_between_0_and_1; [trivial|now apply Forall_app|].
  eapply Qlt_le_trans; [exact H|]. apply pr_monotone; [trivial|]. intros a.
  unfold meets_all, meets. rewrite !map_app, !forallb_app. cbn.
  now intros [-> [_ ->]%andb_prop]%andb_prop.
Qed.

Lemma pr_without_requirements prior B : 0 < mass prior ->
  pr B (under_scene prior []) == probability B prior.
Proof.
  intros M. unfold under_scene. rewrite pr_normalised. unfold mass at 1, pr at 1.
  rewrite !expect_per_scene_nil. fold (mass prior). fold (pr B prior).
  unfold probability. field. lra.
Qed.

Theorem probability_under_scene_is_p_plus_1_minus_p_times_q prior p B (q := probability B prior) :
  nonnegative prior -> 0 < mass prior -> 0 < q ->
  pr B (under_scene prior [(p, B)]) == p + (1 - p) * q.
Proof.
  intros N M H. rewrite (each_of_several_requirements_holds_under_scene_with_p_and_beyond_that_as_often_as_without_it prior [] p B []).
  - cbn [app]. now rewrite pr_without_requirements.
  - trivial.
  - assert (0 < pr B prior) as L by (rewrite pr_is_a_part by trivial; fold q; nra).
    eapply Qlt_le_trans; [exact L|]. apply pr_monotone; [trivial|]. intros a E. cbn.
    now rewrite E.
Qed.

(** The edge: where B never holds, scenes come from tails alone, and there are none if p is 1. *)
Theorem what_never_holds_does_not_hold_under_scene prior p B :
  nonnegative prior -> pr B prior == 0 -> pr B (under_scene prior [(p, B)]) == 0.
Proof.
  intros N Z. unfold under_scene. rewrite pr_normalised. unfold pr at 1.
  rewrite expect_per_scene_cons, !expect_per_scene_nil, expect_given.
  assert (expect (fun a => indicator (B a) * indicator (B a)) prior == 0) as ->.
  { rewrite <- Z. apply expect_ext. intros a. destruct (B a); cbn; ring. }
  fold (pr B prior). rewrite Z. unfold Qdiv. ring.
Qed.

Theorem probability_under_scene_is_at_least_p_iff_q_is_positive_or_p_is_0
    prior p B (q := probability B prior) :
  nonnegative prior -> 0 < mass prior -> 0 <= p <= 1 ->
  p <= pr B (under_scene prior [(p, B)]) <-> 0 < q \/ p == 0.
Proof.
  intros N M P. pose proof (probability_is_between_0_and_1 B prior N M) as R. fold q in R.
  destruct (Qlt_le_dec 0 q) as [L|L].
  - rewrite probability_under_scene_is_p_plus_1_minus_p_times_q by trivial. fold q.
    split; [now left|]. intros _. nra.
  - assert (pr B prior == 0) as Z by (rewrite pr_is_a_part by trivial; fold q; nra).
    rewrite what_never_holds_does_not_hold_under_scene by trivial.
    split; [right; lra|]. intros [H|H]; lra.
Qed.

(** How far the readings are apart. *)
Theorem scene_exceeds_run_by_p_times_1_minus_p_times_the_square_of_1_minus_q
    prior p B (q := probability B prior) :
  nonnegative prior -> 0 < mass prior -> 0 <= p <= 1 -> 0 < q ->
  pr B (under_scene prior [(p, B)]) - pr B (under_run prior [(p, B)])
  == p * (1 - p) * (1 - q) * (1 - q) / (1 - p + p * q).
Proof.
  intros N M P H. pose proof (probability_is_between_0_and_1 B prior N M) as R. fold q in R.
  pose proof (accepted_part_is_positive p q P R (or_intror H)) as D.
  rewrite probability_under_scene_is_p_plus_1_minus_p_times_q by trivial.
  rewrite probability_under_run_is_q_over_1_minus_p_plus_p_q by (trivial; fold q; lra).
  fold q. field. lra.
Qed.

End Readings.

(** ** The claim of Section 5.1 *)

(** "This ensures that the condition B will hold with probability at least p", where B can hold at all: else it fails under both readings
    ([what_never_holds_does_not_hold_under_scene]). *)
Definition claim (reading : forall A, dist A -> list (soft A) -> dist A) : Prop :=
  forall A (prior : dist A) p (B : A -> bool),
    nonnegative prior -> mass prior == 1 -> 0 < p < 1 -> 0 < pr B prior ->
    p <= pr B (reading A prior [(p, B)]).

(** The witness of `scenic-ref readings soft`, with a coin of probability 1/10 for x < 0.1. *)
Theorem require_one_half_of_one_tenth_holds_with_two_elevenths :
  pr (fun b => b) (under_run (coin (1 # 10)) [(1 # 2, fun b => b)]) == 2 # 11.
Proof. reflexivity. Qed.

Theorem under_scene_it_holds_with_eleven_twentieths :
  pr (fun b => b) (under_scene (coin (1 # 10)) [(1 # 2, fun b => b)]) == 11 # 20.
Proof. reflexivity. Qed.

Theorem the_claim_is_false_under_run : ~ claim (@under_run).
Proof.
  intros H. specialize (H bool (coin (1 # 10)) (1 # 2) (fun b => b)).
  rewrite require_one_half_of_one_tenth_holds_with_two_elevenths in H.
  apply H; try reflexivity; [apply nonnegative_coin|]; split; now compute.
Qed.

Theorem the_claim_is_true_under_scene_of_what_is_possible : claim (@under_scene).
Proof.
  intros A prior p B N M P H.
  apply probability_under_scene_is_at_least_p_iff_q_is_positive_or_p_is_0; try lra; [trivial|].
  left. unfold probability. rewrite M. unfold Qdiv. now rewrite Qmult_1_r.
Qed.

(** No probability but 0 and 1 is safe under `run`: however high the demand, there is a condition that can hold and that holds as rarely as one
    likes (its prior q is small enough). The shortfall is then as near to p as one likes; it is never more. *)
Theorem under_run_each_demand_can_be_met_with_any_small_probability p e :
  0 < p < 1 -> 0 < e ->
  exists q, 0 < q <= 1 /\ pr (fun b => b) (under_run (coin q) [(p, fun b => b)]) < e.
Proof.
  intros P L. set (m := if Qlt_le_dec e 1 then e else 1).
  assert (0 < m <= 1 /\ m <= e) as [I J] by (unfold m; destruct (Qlt_le_dec e 1); lra).
  exists (m * (1 - p) * (1 # 2)).
  assert (0 < m * (1 - p) * (1 # 2) <= 1) as R by nra. split; [trivial|].
  set (q := m * (1 - p) * (1 # 2)) in *.
  assert (mass (coin q) == 1) as M by apply mass_coin.
  assert (probability (fun b => b) (coin q) == q) as V.
  { unfold probability. rewrite M. unfold pr. rewrite expect_coin. cbn [indicator]. field. }
  assert (0 <= p * q) by (apply Qmult_le_0_compat; lra).
  assert (0 < m * (1 - p)) by nra.
  rewrite probability_under_run_is_q_over_1_minus_p_plus_p_q; rewrite ?V, ?M; [|lra|lra].
  apply Qlt_shift_div_r; [lra|]. apply Qlt_le_trans with (m * (1 - p)); [unfold q; lra|]. nra.
Qed.

(** Under `scene` the claim needs that the requirements can all be met: of two that
    contradict each other, each with a prior of 1/4, each holds with 5/12, not with 1/2. *)
Theorem contradictory_requirements_fall_short_under_scene :
  let prior := [(1%nat, 1 # 4); (2%nat, 1 # 4); (3%nat, 1 # 2)] in
  let r n := (1 # 2, Nat.eqb n) in
  pr (Nat.eqb 1) (under_scene prior [r 1%nat; r 2%nat]) == 5 # 12
  /\ pr (Nat.eqb 2) (under_scene prior [r 1%nat; r 2%nat]) == 5 # 12.
Proof. now split. Qed.
