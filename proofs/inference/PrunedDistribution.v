(** Pruning leaves the distribution of a scenario as it is where what is removed has probability zero under the requirements:
    `inference/pruning/analysis.py`. The paper's Section "Domain-Specific Sampling Techniques". Where that does not hold, it may change the
    distribution: two examples. That the algorithms keep the positions that meet their geometric premises is in `Pruning`, for regions of the
    plane; here a position is one of finitely many values. `PrunedScenarios` joins the two. *)
From Coq Require Import List QArith Bool Lqa.
From ScenicRef Require Import kernel.Distribution.
Import ListNotations.
Local Open Scope Q_scope.

(** A scenario: a position is drawn from the prior `d`, and `rest` gives the accepted runs that go on from it, with their probabilities. *)
Definition runs {A B} (d : dist A) (rest : A -> dist B) : dist B := normalised (bind d rest).

(** The same where the position is drawn from what pruning keeps. *)
Definition pruned_runs {A B} (kept : A -> bool) (d : dist A) (rest : A -> dist B) : dist B := runs (normalised (given kept d)) rest.

(** Only what may be drawn counts. *)
Lemma expect_of_what_is_kept A B (f : B -> Q) (kept : A -> bool) (d : dist A) (rest : A -> dist B) :
  (forall x, nonnegative (rest x)) -> (forall x p, In (x, p) d -> kept x = false -> mass (rest x) == 0) ->
  expect f (bind (given kept d) rest) == expect f (bind d rest).
Proof.
  intros N Z. rewrite !expect_bind, expect_given. apply expect_ext_in. intros x p I. destruct (kept x) eqn:K; cbn [indicator]; [ring|].
  rewrite (expect_without_mass _ f (rest x) (N x) (Z x p I K)). ring.
Qed.

(** Also where nothing is kept: then there was no accepted run. *)
Theorem pruning_what_no_accepted_run_has_leaves_the_distribution_as_it_is A B (kept : A -> bool) (d : dist A) (rest : A -> dist B) :
  nonnegative d -> (forall x, nonnegative (rest x)) -> (forall x p, In (x, p) d -> kept x = false -> mass (rest x) == 0) ->
  same (pruned_runs kept d rest) (runs d rest).
Proof.
  intros N R Z f. unfold pruned_runs, runs. rewrite !expect_normalised. unfold mass.
  assert (forall g, expect g (bind (normalised (given kept d)) rest) == / pr kept d * expect g (bind d rest)) as E.
  { intros g. rewrite expect_bind. unfold normalised. rewrite expect_scale, mass_given, <- expect_bind.
    now rewrite (expect_of_what_is_kept _ _ g kept d rest R Z). }
  rewrite !E. destruct (Qeq_dec (pr kept d) 0) as [P|P].
  - assert (forall g, expect g (bind d rest) == 0) as O; [|rewrite !O; unfold Qdiv; ring].
    intros g. rewrite <- (expect_of_what_is_kept _ _ g kept d rest R Z), expect_bind.
    apply expect_without_mass; [now apply nonnegative_given|now rewrite mass_given].
  - unfold Qdiv. rewrite Qinv_mult_distr. set (x := expect f _). set (y := / expect _ _). rewrite Qinv_involutive.
    field. exact P.
Qed.

(** * Where it does not hold *)

Definition uniform (values : list nat) : dist nat := map (fun v => (v, 1 # Pos.of_nat (length values))) values.
Definition in_container (x : nat) : bool := Nat.leb 1 x.

(** An object at 0 or 1 is moved by 0 or 1 when it is mutated, and has to be in the container, at 1 or further, after that. *)
Definition mutated (x : nat) : dist nat := given in_container (bind (uniform [0; 1]%nat) (fun noise => ret (x + noise)%nat)).

Theorem pruning_before_a_mutation_changes_the_distribution :
  pr (Nat.eqb 1) (runs (uniform [0; 1]%nat) mutated) == 2 # 3 /\
  pr (Nat.eqb 1) (pruned_runs in_container (uniform [0; 1]%nat) mutated) == 1 # 2.
Proof. now split. Qed.

(** An object at 0 or 1 has to be in the container with probability 1/2. *)
Definition softly_contained (x : nat) : dist nat := bind (coin (1 # 2)) (fun checked => given (fun y => negb checked || in_container y) (ret x)).

Theorem pruning_by_a_soft_requirement_changes_the_distribution :
  pr (Nat.eqb 0) (runs (uniform [0; 1]%nat) softly_contained) == 1 # 3 /\
  pr (Nat.eqb 0) (pruned_runs in_container (uniform [0; 1]%nat) softly_contained) == 0.
Proof. now split. Qed.
