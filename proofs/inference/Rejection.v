(** Rejection sampling and its relatives, on programs whose draws have finitely many values.

    "Our implementation uses rejection sampling, generating scenes from the imperative part of
    the scenario until all requirements are satisfied. While this samples from exactly the
    desired distribution, ..." (the paper, "Domain-Specific Sampling Techniques"). It does
    ([a_scene_found_within_n_attempts_has_the_desired_distribution]), and so do

    - factorised rejection, where a component that is independent of the others is drawn again
      by itself until what is required of it alone holds (inference/batch/factorised_rejection.py);
    - weighted runs, in expectation (inference/importance.py weighs runs by the survival of their
      coins, which is [weighing_by_survival_gives_the_law_under_run] of SoftRequirements);
    - moves that are as likely back as forth, taken where the requirements allow it
      (inference/mcmc.py, the moves redraw and exchange of inference/moves/proposals.py), in that they leave the
      distribution as it is;

    but it will not do to draw only the object that collides again, nor a component that
    depends on another.

    A program is here the distribution of its draws, and a test that tells whether the run
    with these draws is accepted; the desired distribution is that of the accepted runs,
    normalised ("Semantics of a Scenic Program"; inference/enumeration.py). *)
From Coq Require Import Qminmax Setoid Morphisms Lqa Bool.
From ScenicRef Require Import kernel.Distribution scenes.SoftRequirements.
Import ListNotations.
Open Scope Q_scope.

Definition desired {A} (accepts : A -> bool) (d : dist A) : dist A := normalised (given accepts d).

Lemma expect_desired A accepts (d : dist A) f :
  expect f (desired accepts d) == expect (fun a => indicator (accepts a) * f a) d / pr accepts d.
Proof. unfold desired. now rewrite expect_normalised, expect_given, mass_given. Qed.

(** ** Rejection (inference/rejection.py) *)

(** `sample`, with at most [n] attempts: the first accepted run, if any. *)
Fixpoint sample {A} (accepts : A -> bool) (d : dist A) (n : nat) : dist (option A) :=
  match n with
  | O => ret None
  | S n => bind d (fun a => if accepts a then ret (Some a) else sample accepts d n)
  end.

Definition found {A} (d : dist (option A)) : dist A :=
  bind d (fun o => match o with Some a => ret a | None => stuck end).
Definition is_none {A} (o : option A) : bool := match o with Some _ => false | None => true end.

(** r^0 + r^1 + ... + r^(n-1). *)
Fixpoint power (r : Q) (n : nat) : Q := match n with O => 1 | S n => r * power r n end.
Fixpoint geometric (r : Q) (n : nat) : Q :=
  match n with O => 0 | S n => geometric r n + power r n end.

Lemma geometric_sum r n : (1 - r) * geometric r n == 1 - power r n.
Proof.
  induction n as [|n IH]; cbn [geometric power]; [ring|].
  rewrite Qmult_plus_distr_r, IH. ring.
Qed.

Lemma geometric_unfolds r n : geometric r (S n) == 1 + r * geometric r n.
Proof.
  induction n as [|n IH]; [cbn; ring|].
  change (geometric r (S (S n))) with (geometric r (S n) + power r (S n)).
  rewrite IH at 1. cbn [geometric power]. ring.
Qed.

Lemma power_is_nonnegative r n : 0 <= r -> 0 <= power r n.
Proof. intros R. induction n; cbn [power]; [lra|]. now apply Qmult_le_0_compat. Qed.

Lemma geometric_is_positive r n : 0 <= r -> 0 < geometric r (S n).
Proof.
  intros R. induction n as [|n IH]; [cbn; lra|].
  change (geometric r (S (S n))) with (geometric r (S n) + power r (S n)).
  pose proof (power_is_nonnegative r (S n) R). lra.
Qed.

Section Rejection.
Context {A : Type} (accepts : A -> bool) (d : dist A).
Let acceptance := pr accepts d.
Let rejection := pr (fun a => negb (accepts a)) d.

(** No attempt of [n] is accepted. *)
Theorem all_attempts_fail_with_the_nth_power n :
  pr is_none (sample accepts d n) == power rejection n.
Proof.
  unfold pr. induction n as [|n IH]; [cbn [sample power]; now rewrite expect_ret|].
  cbn [sample power]. rewrite expect_bind. unfold rejection, pr. rewrite <- expect_times_right.
  apply expect_ext. intros a.
  destruct (accepts a); cbn [negb indicator]; [rewrite expect_ret; cbn; ring|]. rewrite IH.
  unfold rejection, pr. ring.
Qed.

Theorem sampling_loses_nothing n : mass d == 1 -> mass (sample accepts d n) == 1.
Proof.
  intros M. induction n as [|n IH]; [reflexivity|]. cbn [sample].
  rewrite bind_preserves_mass; [trivial|]. intros a. now destruct (accepts a).
Qed.

Lemma expect_found f n :
  expect f (found (sample accepts d n))
  == expect (fun o => match o with Some a => f a | None => 0 end) (sample accepts d n).
Proof.
  unfold found. rewrite expect_bind. apply expect_ext.
  intros [a|]; [apply expect_ret | apply expect_stuck].
Qed.

(** What [n] attempts find is what one finds, but for a factor. *)
Theorem n_attempts_find_a_multiple_of_what_one_finds n :
  found (sample accepts d n) ≈ scale (geometric rejection n) (given accepts d).
Proof.
  intros f. rewrite expect_scale, expect_given. induction n as [|n IH].
  - rewrite expect_found. cbn [sample geometric]. rewrite expect_ret. ring.
  - rewrite geometric_unfolds, Qmult_plus_distr_l, <- Qmult_assoc, <- IH.
    rewrite expect_found. cbn [sample]. rewrite expect_bind. unfold rejection at 1, pr.
    rewrite <- expect_times_right, Qmult_1_l, <- expect_plus.
    apply expect_ext. intros a. destruct (accepts a); cbn [negb indicator].
    + rewrite expect_ret. ring.
    + rewrite <- expect_found. ring.
Qed.

Theorem a_scene_is_found_within_n_attempts_unless_all_fail n :
  mass d == 1 -> mass (found (sample accepts d n)) == 1 - power rejection n.
Proof.
  intros M. rewrite n_attempts_find_a_multiple_of_what_one_finds, mass_scale, mass_given.
  rewrite <- geometric_sum. pose proof (pr_complement _ accepts d) as C. rewrite M in C.
  fold acceptance rejection in C. fold acceptance.
  assert (1 - rejection == acceptance) as -> by lra. ring.
Qed.

(** THE THEOREM: however many attempts are allowed, if there is a scene then it has the
    desired distribution. *)
Theorem a_scene_found_within_n_attempts_has_the_desired_distribution n :
  nonnegative d -> normalised (found (sample accepts d (S n))) ≈ desired accepts d.
Proof.
  intros N. rewrite n_attempts_find_a_multiple_of_what_one_finds.
  apply normalised_forgets_a_factor.
  enough (0 < geometric rejection (S n)) by lra.
  apply geometric_is_positive. now apply pr_nonnegative.
Qed.

(** `Enumeration.attempts_probability`: that the first accepted run is number [n + 1]. *)
Theorem a_scene_takes_n_more_attempts_with_a_geometric_probability n :
  mass d == 1 ->
  mass (found (sample accepts d (S n))) - mass (found (sample accepts d n))
  == power rejection n * acceptance.
Proof.
  intros M. rewrite !a_scene_is_found_within_n_attempts_unless_all_fail by trivial.
  cbn [power]. pose proof (pr_complement _ accepts d) as C. rewrite M in C.
  fold acceptance rejection in C. assert (acceptance == 1 - rejection) as -> by lra. ring.
Qed.
End Rejection.

(** With soft requirements the coins are draws of the run, under reading `run` of `soft`... *)
Theorem rejection_with_coins_in_the_run_samples_the_law_under_run A (prior : dist A) rs n :
  nonnegative prior -> Forall (fun r => 0 <= fst r <= 1) rs ->
  let accepts run := meets (snd run) (fst run) in
  bind (normalised (found (sample accepts (product prior (throw rs)) (S n))))
       (fun run => ret (fst run))
  ≈ under_run prior rs.
Proof.
  intros N F accepts. rewrite a_scene_found_within_n_attempts_has_the_desired_distribution.
  - rewrite run_throws_first_and_normalises_at_the_end. intros f.
    assert (forall g, expect g (bind (throw rs) (fun bs => given (meets bs) prior))
      == expect (fun run => indicator (accepts run) * g (fst run)) (product prior (throw rs)))
      as E.
    { intros g. rewrite expect_bind, expect_product, expect_swap. apply expect_ext. intros bs.
      apply expect_given. }
    rewrite expect_bind, expect_desired, expect_normalised. unfold mass. rewrite !E.
    apply Qmult_comp; [|apply Qinv_comp]; apply expect_ext; intros run;
      [rewrite expect_ret; reflexivity | ring].
  - unfold product. apply nonnegative_bind; [trivial|]. intros a.
    apply nonnegative_bind; [now apply nonnegative_throw|]. intros bs. apply nonnegative_ret.
Qed.

(** ... and under `scene` each result of them has a rejection loop of its own. *)
Theorem rejection_with_the_coins_thrown_before_samples_each_loop A (prior : dist A) demanded n :
  nonnegative prior ->
  normalised (found (sample (meets demanded) prior (S n))) ≈ loop prior demanded.
Proof.
  intros N. change (loop prior demanded) with (desired (meets demanded) prior).
  now apply a_scene_found_within_n_attempts_has_the_desired_distribution.
Qed.

(** With a limit on the attempts at each scene, and given that a scene is found: results of the coins under which a run is seldom accepted count for
    less, for they are those under which all attempts fail. *)
Definition found_per_scene {A} (prior : dist A) rs (attempts : nat) : dist A :=
  normalised (bind (throw rs) (fun demanded => found (sample (meets demanded) prior attempts))).

Theorem under_scene_a_limit_weighs_each_loop_by_the_chance_to_find_a_scene A (prior : dist A) rs n :
  nonnegative prior -> mass prior == 1 ->
  found_per_scene prior rs n
  ≈ normalised (bind (throw rs) (fun demanded =>
      scale (1 - power (pr (fun a => negb (meets demanded a)) prior) n) (loop prior demanded))).
Proof.
  intros N M. unfold found_per_scene. apply normalised_respects, bind_respects; [reflexivity|]. intros demanded f.
  rewrite (n_attempts_find_a_multiple_of_what_one_finds (meets demanded) prior n f), !expect_scale. unfold loop. rewrite expect_normalised, mass_given, <- geometric_sum.
  pose proof (pr_complement _ (meets demanded) prior) as C. rewrite M in C.
  assert (1 - pr (fun a => negb (meets demanded a)) prior == pr (meets demanded) prior) as -> by lra.
  destruct (Qeq_dec (pr (meets demanded) prior) 0) as [Z|Z].
  - rewrite Z, (expect_without_mass _ f (given (meets demanded) prior)); [ring|now apply nonnegative_given|now rewrite mass_given].
  - unfold Qdiv. field. exact Z.
Qed.

(** With one attempt the readings are the same, so that the claim of Section 5.1 is as false. *)
Theorem with_one_attempt_at_each_scene_the_readings_agree A (prior : dist A) rs : found_per_scene prior rs 1 ≈ under_run prior rs.
Proof.
  rewrite run_throws_first_and_normalises_at_the_end. unfold found_per_scene. apply normalised_respects, bind_respects; [reflexivity|].
  intros demanded f. rewrite (n_attempts_find_a_multiple_of_what_one_finds (meets demanded) prior 1 f), expect_scale. cbn. ring.
Qed.

(** ** Factorised rejection (batch/evaluate/components.py) *)

Section Factorised.
Context {A B : Type} (d : dist A) (e : dist B).
Context (accepts_a : A -> bool) (accepts_b : B -> bool) (accepts_both : A * B -> bool).

(** The run is accepted: what is required of each component, and of both together. *)
Definition accepts_all (ab : A * B) : bool :=
  accepts_a (fst ab) && accepts_b (snd ab) && accepts_both ab.

Lemma expect_given_both f :
  expect f (given accepts_all (product d e))
  == expect f (given accepts_both (product (given accepts_a d) (given accepts_b e))).
Proof.
  rewrite !expect_given, !expect_product, expect_given. apply expect_ext. intros a.
  rewrite expect_given, <- expect_times. apply expect_ext. intros b.
  unfold accepts_all. cbn [fst snd].
  destruct (accepts_a a), (accepts_b b), (accepts_both (a, b)); cbn; ring.
Qed.

Lemma product_of_multiples x y (g : dist A) (h : dist B) :
  product (scale x g) (scale y h) ≈ scale (x * y) (product g h).
Proof.
  intros f. rewrite expect_scale, !expect_product, expect_scale, <- expect_times, <- expect_times.
  apply expect_ext. intros a. rewrite expect_scale. ring.
Qed.

Lemma given_of_multiple x E (g : dist (A * B)) : given E (scale x g) ≈ scale x (given E g).
Proof. intros f. now rewrite expect_scale, !expect_given, expect_scale. Qed.

(** Each component apart, until it is accepted; both anew, where they do not fit together. *)
Definition factorised : dist (A * B) :=
  desired accepts_both (product (desired accepts_a d) (desired accepts_b e)).

Theorem factorised_rejection_has_the_desired_distribution :
  ~ pr accepts_a d == 0 -> ~ pr accepts_b e == 0 ->
  factorised ≈ desired accepts_all (product d e).
Proof.
  intros Ha Hb. unfold factorised, desired at 1 4.
  rewrite (normalised_respects _ (given accepts_all (product d e))
             (given accepts_both (product (given accepts_a d) (given accepts_b e))))
    by (intros f; apply expect_given_both).
  unfold desired, normalised at 2 3. rewrite !mass_given, product_of_multiples, given_of_multiple.
  apply normalised_forgets_a_factor. intros Z.
  apply Qmult_integral in Z as [Z|Z]; [apply Ha | apply Hb].
  - rewrite <- Qinv_involutive, Z. reflexivity.
  - rewrite <- Qinv_involutive, Z. reflexivity.
Qed.

(** The same with limits on the attempts at each component, and at the whole. *)
Theorem factorised_rejection_with_limits_has_the_desired_distribution m n k :
  nonnegative d -> nonnegative e ->
  normalised (found (sample accepts_both
    (product (found (sample accepts_a d (S m))) (found (sample accepts_b e (S n)))) (S k)))
  ≈ desired accepts_all (product d e).
Proof.
  intros Nd Ne.
  rewrite a_scene_found_within_n_attempts_has_the_desired_distribution.
  - unfold desired.
    rewrite (normalised_respects _ (given accepts_all (product d e))
               (given accepts_both (product (given accepts_a d) (given accepts_b e))))
      by (intros f; apply expect_given_both).
    rewrite !n_attempts_find_a_multiple_of_what_one_finds, product_of_multiples, given_of_multiple.
    apply normalised_forgets_a_factor.
    enough (0 < geometric (pr (fun a => negb (accepts_a a)) d) (S m)
                * geometric (pr (fun b => negb (accepts_b b)) e) (S n)) by lra.
    apply Qmult_lt_0_compat; apply geometric_is_positive; now apply pr_nonnegative.
  - assert (forall T (E : T -> bool) (g : dist T) j, nonnegative g ->
            nonnegative (found (sample E g j))) as W.
    { intros T E g j Ng. unfold found. apply nonnegative_bind.
      - induction j as [|j IH]; cbn [sample]; [apply nonnegative_ret|].
        apply nonnegative_bind; [trivial|]. intros t.
        destruct (E t); [apply nonnegative_ret|trivial].
      - intros [t|]; [apply nonnegative_ret|constructor]. }
    unfold product. apply nonnegative_bind; [now apply W|]. intros a.
    apply nonnegative_bind; [now apply W|]. intros b. apply nonnegative_ret.
Qed.
End Factorised.

(** ** Repairs that are wrong *)

(** Draw one object, then the other, given the first, again and again until they do not
    collide: the limit of all attempts. *)
Definition repaired {A B} (accepts : A * B -> bool) (d : dist A) (e : A -> dist B) : dist (A * B) :=
  bind d (fun a => bind (desired (fun b => accepts (a, b)) (e a)) (fun b => ret (a, b))).

(** The other object is then as before, whatever the requirement says of it... *)
Theorem repairing_one_object_leaves_the_other_as_it_was
    {A B} (accepts : A * B -> bool) (d : dist A) (e : A -> dist B) f :
  (forall a, ~ pr (fun b => accepts (a, b)) (e a) == 0) ->
  expect (fun ab => f (fst ab)) (repaired accepts d e) == expect f d.
Proof.
  intros H. unfold repaired. rewrite expect_bind. apply expect_ext. intros a.
  rewrite expect_bind, (expect_ext _ _ (fun _ => f a)) by (intros b; now rewrite expect_ret).
  rewrite expect_constant. unfold desired. rewrite what_has_mass_has_mass_1_when_normalised; [ring|]. now rewrite mass_given.
Qed.

(** ... so that this is wrong: x = Uniform(0, 1), y = Uniform(1, 2, 3), require x != y. Of the
    five scenes three have x = 0; repaired ones have x = 0 as often as x = 1. *)
Definition example_x : dist nat := [(0%nat, 1 # 2); (1%nat, 1 # 2)].
Definition example_y : dist nat := [(1%nat, 1 # 3); (2%nat, 1 # 3); (3%nat, 1 # 3)].
Definition apart (ab : nat * nat) : bool := negb (Nat.eqb (fst ab) (snd ab)).

Theorem repairing_only_the_colliding_object_is_wrong :
  pr (fun ab => Nat.eqb (fst ab) 0) (desired apart (product example_x example_y)) == 3 # 5
  /\ pr (fun ab => Nat.eqb (fst ab) 0) (repaired apart example_x (fun _ => example_y)) == 1 # 2.
Proof. now split. Qed.

(** The premise that components are independent is needed: where y is drawn relative to x, it may
    not be drawn again by itself, even if the requirement is about y alone. *)
Definition example_beside (x : nat) : dist nat :=
  [(x, 1 # 2); ((x + 1)%nat, 1 # 4); ((x + 2)%nat, 1 # 4)].

Theorem redrawing_a_dependent_component_is_wrong :
  let joint := bind example_x (fun x => bind (example_beside x) (fun y => ret (x, y))) in
  let required (ab : nat * nat) := Nat.leb 2 (snd ab) in
  pr (fun ab => Nat.eqb (fst ab) 0) (desired required joint) == 1 # 3
  /\ pr (fun ab => Nat.eqb (fst ab) 0) (repaired required example_x example_beside) == 1 # 2.
Proof. now split. Qed.

(** ** Importance weights *)

(** A weight for each value of a finite space. *)
Definition table {A} (space : list A) (weight : A -> Q) : dist A :=
  map (fun a => (a, weight a)) space.

Lemma expect_table_cons A (a : A) space weight f :
  expect f (table (a :: space) weight) == weight a * f a + expect f (table space weight).
Proof. apply expect_cons. Qed.

Section Importance.
Context {A : Type} (space : list A) (p q : A -> Q).
Let w (a : A) : Q := p a / q a.
Hypothesis support : forall a, In a space -> q a == 0 -> p a == 0.

Theorem importance_weights_are_unbiased f :
  expect (fun a => w a * f a) (table space q) == expect f (table space p).
Proof.
  revert support. induction space as [|a rest IH]; intros S; [reflexivity|].
  rewrite !expect_table_cons, IH by (intros b I; apply S; now right).
  apply Qplus_comp; [|reflexivity]. unfold w. destruct (Qeq_dec (q a) 0) as [Z|Z].
  - rewrite Z, (S a) by (trivial; now left). ring.
  - field. trivial.
Qed.

(** Where [p] is the mass of the accepted runs, the ratio is the expectation in scenes. *)
Theorem the_ratio_of_weighted_means_is_the_conditional_expectation f :
  expect (fun a => w a * f a) (table space q) / expect w (table space q)
  == expect f (normalised (table space p)).
Proof.
  rewrite expect_normalised, importance_weights_are_unbiased.
  apply Qmult_comp; [reflexivity|]. apply Qinv_comp.
  unfold mass. rewrite <- importance_weights_are_unbiased.
  apply expect_ext. intros a. ring.
Qed.
End Importance.

(** The mean over [n] runs is right in expectation, whatever is averaged. *)
Fixpoint runs {A} (d : dist A) (n : nat) : dist (list A) :=
  match n with
  | O => ret []
  | S n => bind d (fun a => bind (runs d n) (fun l => ret (a :: l)))
  end.
Definition total {A} (f : A -> Q) (l : list A) : Q := fold_right (fun a sum => f a + sum) 0 l.

Theorem the_total_of_n_runs_is_n_times_the_expectation A (d : dist A) f n :
  mass d == 1 -> expect (total f) (runs d n) == inject_Z (Z.of_nat n) * expect f d.
Proof.
  intros M. assert (forall k, mass (runs d k) == 1) as R.
  { intros k. induction k as [|k IH]; [reflexivity|]. cbn [runs].
    rewrite bind_preserves_mass; [trivial|]. intros a.
    rewrite bind_preserves_mass; [trivial|]. intros l. apply mass_ret. }
  induction n as [|n IH]; [cbn [runs]; rewrite expect_ret; cbn; ring|].
  cbn [runs]. rewrite expect_bind.
  rewrite (expect_ext _ _ (fun a => f a + inject_Z (Z.of_nat n) * expect f d)).
  - rewrite expect_plus, expect_constant, M, Nat2Z.inj_succ. unfold Z.succ.
    rewrite inject_Z_plus. ring.
  - intros a. rewrite expect_bind.
    rewrite (expect_ext _ _ (fun l => f a + total f l)) by (intros l; apply expect_ret).
    rewrite expect_plus, expect_constant, R, IH. ring.
Qed.

(** ** Markov chains (inference/mcmc.py, sites/moves.py, sites/target.py) *)

Section Chains.
Context {A : Type}.
Implicit Types (d : dist A) (move : A -> dist A).

(** Detailed balance: from a state of [d], a move there is as likely as a move back. *)
Definition reversible d move : Prop := forall f : A -> A -> Q,
  expect (fun a => expect (fun b => f a b) (move a)) d
  == expect (fun a => expect (fun b => f b a) (move a)) d.

Definition invariant d move : Prop := bind d move ≈ d.
Definition never_stuck move : Prop := forall a, mass (move a) == 1.

Theorem detailed_balance_implies_invariance d move :
  never_stuck move -> reversible d move -> invariant d move.
Proof.
  intros M R f. rewrite expect_bind, (R (fun _ b => f b)).
  apply expect_ext. intros a. rewrite expect_constant, (M a). ring.
Qed.

Theorem moves_one_after_the_other_leave_the_target_invariant d move move' :
  invariant d move -> invariant d move' -> invariant d (fun a => bind (move a) move').
Proof.
  unfold invariant. intros I I'. rewrite <- bind_assoc.
  transitivity (bind d move'); [|trivial]. apply bind_respects; [trivial|]. now intros a.
Qed.

(** Which kind of move is made is drawn apart from the state (`Moves.propose`). *)
Theorem a_mixture_of_moves_leaves_the_target_invariant
    K (kinds : dist K) (moves : K -> A -> dist A) d :
  mass kinds == 1 -> (forall k, invariant d (moves k)) ->
  invariant d (fun a => bind kinds (fun k => moves k a)).
Proof.
  intros M I f. rewrite (independent_draws_commute _ _ _ d kinds (fun a k => moves k a) f).
  rewrite expect_bind, (expect_ext _ _ (fun _ => expect f d)) by (intros k; apply (I k)).
  rewrite expect_constant, M. ring.
Qed.

Fixpoint chain move (n : nat) (a : A) : dist A :=
  match n with O => ret a | S n => bind (move a) (chain move n) end.

Theorem a_chain_begun_in_the_target_stays_in_it d move n :
  invariant d move -> invariant d (chain move n).
Proof.
  intros I. induction n as [|n IH]; [apply bind_ret_right|].
  now apply (moves_one_after_the_other_leave_the_target_invariant d move (chain move n)).
Qed.

(** The law of Metropolis and Hastings: a proposal that is as likely back as forth under [d] is
    taken with probability min(1, weight there / weight here). The target is [d], weighted. *)
Definition weighted (weight : A -> Q) d : dist A :=
  map (fun aw => (fst aw, weight (fst aw) * snd aw)) d.

Definition ratio (weight : A -> Q) (a b : A) : Q := Qmin 1 (weight b / weight a).
Definition metropolis (weight : A -> Q) move (a : A) : dist A :=
  bind (move a) (fun b =>
  bind (coin (ratio weight a b)) (fun taken => ret (if taken then b else a))).

Lemma expect_weighted weight d f :
  expect f (weighted weight d) == expect (fun a => weight a * f a) d.
Proof.
  induction d as [|[a w] d IH]; [reflexivity|].
  change (weighted weight ((a, w) :: d)) with ((a, weight a * w) :: weighted weight d).
  rewrite !expect_cons, IH. ring.
Qed.

Lemma metropolis_is_never_stuck weight move :
  never_stuck move -> never_stuck (metropolis weight move).
Proof.
  intros M a. unfold metropolis. rewrite bind_preserves_mass; [apply M|]. intros b.
  rewrite bind_preserves_mass; [apply mass_coin|]. intros taken. apply mass_ret.
Qed.

Lemma min_left x y : x <= y -> Qmin x y == x.
Proof. apply Q.min_l. Qed.

Lemma min_symmetric x y : Qmin x y == Qmin y x.
Proof. apply Q.min_comm. Qed.

Lemma min_right x y : y <= x -> Qmin x y == y.
Proof. apply Q.min_r. Qed.

(** How much moves from here to there; it is the same from there to here. *)
Lemma flow weight a b :
  (forall a, 0 <= weight a) -> weight a * ratio weight a b == Qmin (weight a) (weight b).
Proof.
  intros W. unfold ratio. pose proof (W a). pose proof (W b).
  destruct (Qeq_dec (weight a) 0) as [Z|Z].
  - rewrite (min_left (weight a) (weight b)) by lra. rewrite Z. ring.
  - destruct (Qlt_le_dec (weight a) (weight b)) as [L|L].
    + rewrite !min_left; [ring|lra|]. apply Qle_shift_div_l; lra.
    + rewrite !min_right; [field; lra|trivial|]. apply Qle_shift_div_r; lra.
Qed.

Theorem metropolis_is_reversible weight d move :
  (forall a, 0 <= weight a) -> reversible d move ->
  reversible (weighted weight d) (metropolis weight move).
Proof.
  intros W R f. rewrite !expect_weighted.
  (* what stays is the same on both sides; what moves is balanced *)
  assert (forall g : A -> A -> Q,
    expect (fun a => weight a * expect (g a) (metropolis weight move a)) d
    == expect (fun a => expect (fun b => Qmin (weight a) (weight b) * g a b) (move a)) d
     + expect (fun a =>
         expect (fun b => (weight a - Qmin (weight a) (weight b)) * g a a) (move a)) d)
    as split.
  { intros g. rewrite <- expect_plus. apply expect_ext. intros a.
    rewrite <- expect_plus. unfold metropolis. rewrite expect_bind, <- expect_times.
    apply expect_ext. intros b. rewrite expect_bind, expect_coin, !expect_ret.
    rewrite <- (flow weight a b W). ring. }
  rewrite (split f), (split (fun a b => f b a)).
  apply Qplus_comp; [|reflexivity].
  rewrite (R (fun a b => Qmin (weight a) (weight b) * f a b)).
  apply expect_ext. intros a. apply expect_ext. intros b. now rewrite (min_symmetric (weight a)).
Qed.

Theorem metropolis_hastings_leaves_the_target_invariant weight d move :
  (forall a, 0 <= weight a) -> never_stuck move -> reversible d move ->
  invariant (weighted weight d) (metropolis weight move).
Proof.
  intros W M R. apply detailed_balance_implies_invariance.
  - now apply metropolis_is_never_stuck.
  - now apply metropolis_is_reversible.
Qed.

(** `Target.update`: a proposal is taken if the requirements hold there. *)
Definition where_accepted (accepts : A -> bool) move (a : A) : dist A :=
  bind (move a) (fun b => ret (if accepts b then b else a)).

Theorem moves_within_the_accepted_runs_are_reversible accepts d move :
  reversible d move -> reversible (given accepts d) (where_accepted accepts move).
Proof.
  intros R f. rewrite !expect_given.
  assert (forall g : A -> A -> Q,
    expect (fun a => indicator (accepts a) * expect (g a) (where_accepted accepts move a)) d
    == expect (fun a => expect (fun b => indicator (accepts a && accepts b) * g a b) (move a)) d
     + expect (fun a =>
         expect (fun b => indicator (accepts a && negb (accepts b)) * g a a) (move a)) d)
    as split.
  { intros g. rewrite <- expect_plus. apply expect_ext. intros a.
    rewrite <- expect_plus. unfold where_accepted. rewrite expect_bind, <- expect_times.
    apply expect_ext. intros b. rewrite expect_ret.
    destruct (accepts a), (accepts b); cbn; ring. }
  rewrite (split f), (split (fun a b => f b a)).
  apply Qplus_comp; [|reflexivity].
  rewrite (R (fun a b => indicator (accepts a && accepts b) * f a b)).
  apply expect_ext. intros a. apply expect_ext. intros b. now rewrite andb_comm.
Qed.

Lemma where_accepted_is_never_stuck accepts move :
  never_stuck move -> never_stuck (where_accepted accepts move).
Proof.
  intros M a. unfold where_accepted. rewrite bind_preserves_mass; [apply M|].
  intros b. apply mass_ret.
Qed.

Lemma multiples_are_invariant c d move : invariant d move -> invariant (scale c d) move.
Proof.
  intros I f. rewrite expect_bind, !expect_scale, <- (I f), expect_bind. reflexivity.
Qed.

Theorem moves_within_the_accepted_runs_leave_the_desired_distribution_invariant accepts d move :
  never_stuck move -> reversible d move ->
  invariant (desired accepts d) (where_accepted accepts move).
Proof.
  intros M R. unfold desired, normalised. apply multiples_are_invariant.
  apply detailed_balance_implies_invariance.
  - now apply where_accepted_is_never_stuck.
  - now apply moves_within_the_accepted_runs_are_reversible.
Qed.
End Chains.

(** *** The moves of inference/moves/proposals.py *)

(** redraw: one coordinate anew from its prior, the others ([e]) as they are. *)
Definition redraw {A B} (d : dist A) (ab : A * B) : dist (A * B) :=
  bind d (fun a => ret (a, snd ab)).

Theorem redrawing_a_coordinate_is_reversible A B (d : dist A) (e : dist B) :
  reversible (product d e) (redraw d).
Proof.
  intros f. rewrite !expect_product.
  assert (forall g : A * B -> A * B -> Q,
    expect (fun a => expect (fun b => expect (g (a, b)) (redraw d (a, b))) e) d
    == expect (fun b => expect (fun a => expect (fun a' => g (a, b) (a', b)) d) d) e) as open.
  { intros g. rewrite expect_swap. apply expect_ext. intros b. apply expect_ext. intros a.
    unfold redraw. rewrite expect_bind. apply expect_ext. intros a'. apply expect_ret. }
  rewrite (open f), (open (fun x y => f y x)). apply expect_ext. intros b. apply expect_swap.
Qed.

Lemma redraw_is_never_stuck A B (d : dist A) : mass d == 1 -> never_stuck (@redraw A B d).
Proof. intros M ab. unfold redraw. now rewrite bind_preserves_mass. Qed.

Theorem single_site_metropolis_hastings_leaves_the_desired_distribution_invariant
    A B (d : dist A) (e : dist B) accepts :
  mass d == 1 ->
  invariant (desired accepts (product d e)) (where_accepted accepts (redraw d)).
Proof.
  intros M. apply moves_within_the_accepted_runs_leave_the_desired_distribution_invariant.
  - now apply redraw_is_never_stuck.
  - apply redrawing_a_coordinate_is_reversible.
Qed.

(** The same with weights, such as those of soft requirements whose coins are counted. *)
Theorem single_site_metropolis_hastings_leaves_a_weighted_target_invariant
    A B (d : dist A) (e : dist B) weight :
  mass d == 1 -> (forall ab, 0 <= weight ab) ->
  invariant (weighted weight (product d e)) (metropolis weight (redraw d)).
Proof.
  intros M W. apply metropolis_hastings_leaves_the_target_invariant; [trivial| |].
  - now apply redraw_is_never_stuck.
  - apply redrawing_a_coordinate_is_reversible.
Qed.

(** exchange: two coordinates with the same prior change places. *)
Definition exchange {A B} (aab : A * A * B) : dist (A * A * B) :=
  ret (snd (fst aab), fst (fst aab), snd aab).

Theorem exchanging_two_coordinates_of_one_prior_is_reversible A B (d : dist A) (e : dist B) :
  reversible (product (product d d) e) exchange.
Proof.
  intros f. rewrite !expect_product.
  assert (forall g : A * A * B -> A * A * B -> Q,
    expect (fun a => expect (fun a' => expect (fun b =>
      expect (g (a, a', b)) (exchange (a, a', b))) e) d) d
    == expect (fun a => expect (fun a' => expect (fun b => g (a, a', b) (a', a, b)) e) d) d)
    as open.
  { intros g. apply expect_ext. intros a. apply expect_ext. intros a'. apply expect_ext. intros b.
    unfold exchange. apply expect_ret. }
  rewrite (open f), (open (fun x y => f y x)). apply expect_swap.
Qed.

Theorem exchanges_leave_the_desired_distribution_invariant A B (d : dist A) (e : dist B) accepts :
  invariant (desired accepts (product (product d d) e)) (where_accepted accepts exchange).
Proof.
  apply moves_within_the_accepted_runs_leave_the_desired_distribution_invariant.
  - intros aab. apply mass_ret.
  - apply exchanging_two_coordinates_of_one_prior_is_reversible.
Qed.

(** `Chains.exchange`: neighbours in a ladder of levels exchange their states where each is
    allowed at the other's level. *)
Definition allowed {A} (low high : A -> bool) (aab : A * A * unit) : bool :=
  low (fst (fst aab)) && high (snd (fst aab)).

Theorem exchanges_between_levels_leave_both_invariant A (d : dist A) (low high : A -> bool) :
  invariant (desired (allowed low high) (product (product d d) (ret tt)))
            (where_accepted (allowed low high) exchange).
Proof. apply exchanges_leave_the_desired_distribution_invariant. Qed.

(** *** The same point by point, as detailed balance is usually written *)

Definition sum {A} (f : A -> Q) (space : list A) : Q := expect f (table space (fun _ => 1)).

Lemma sum_ext_in A (f g : A -> Q) space :
  (forall a, In a space -> f a == g a) -> sum f space == sum g space.
Proof.
  intros H. apply expect_ext_in. intros a w I. apply H.
  apply in_map_iff in I as (b & E & I). now inversion E; subst.
Qed.

Lemma expect_table A (space : list A) weight f :
  expect f (table space weight) == sum (fun a => weight a * f a) space.
Proof.
  unfold sum. induction space as [|a space IH]; [reflexivity|].
  rewrite !expect_table_cons, IH. ring.
Qed.

Theorem pointwise_detailed_balance_implies_invariance
    A (space : list A) (target : A -> Q) (move : A -> A -> Q) :
  (forall a, In a space -> sum (move a) space == 1) ->
  (forall a b, In a space -> In b space -> target a * move a b == target b * move b a) ->
  forall b, In b space -> sum (fun a => target a * move a b) space == target b.
Proof.
  intros S D b I. rewrite (sum_ext_in _ _ (fun a => target b * move b a)) by auto.
  unfold sum. rewrite expect_times. fold (sum (move b) space). rewrite S by trivial. ring.
Qed.

(** Where a table is balanced point by point, its moves are [reversible]. *)
Theorem pointwise_detailed_balance_implies_reversibility
    A (space : list A) (target : A -> Q) (move : A -> A -> Q) :
  (forall a b, In a space -> In b space -> target a * move a b == target b * move b a) ->
  reversible (table space target) (fun a => table space (move a)).
Proof.
  intros D f.
  assert (forall g, expect (fun a => expect (g a) (table space (move a))) (table space target)
    == sum (fun a => sum (fun b => target a * move a b * g a b) space) space) as open.
  { intros g. rewrite expect_table. apply sum_ext_in. intros a _.
    rewrite expect_table. unfold sum. rewrite <- expect_times.
    apply expect_ext. intros b. ring. }
  rewrite (open f), (open (fun a b => f b a)). unfold sum at 1 2. rewrite expect_swap.
  apply sum_ext_in. intros a Ia. apply sum_ext_in. intros b Ib. now rewrite (D b a).
Qed.
