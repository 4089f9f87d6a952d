(** Topological order, as [_topological_order] of [semantics/scenes/resolution.py] finds it: round after round, everything
    that has all its predecessors already placed. It is "specifiers S in G in topological order" of phase 5 of the paper's Algorithm 1
    (resolveSpecifiers), with the "G is cyclic" of phase 4.

    - [the_order_found_is_topological]         what is found is a topological order of what was given;
    - [no_order_is_found_only_if_there_is_a_cycle], [what_has_a_topological_order_has_no_cycle]
                                               it is found exactly if the graph is acyclic;
    - [what_is_left_depends_on_what_is_left_and_nothing_else_hangs_on_a_cycle]
                                               what is left where none is found. *)
From Coq Require Import List Arith Lia Permutation Bool Relations Wellfounded.
Import ListNotations.

Section Ordering.
  Variable vertex : Type.
  Variable same : forall x y : vertex, {x = y} + {x <> y}.
  Variable predecessors : vertex -> list vertex.

  (** All predecessors of [x] are placed. *)
  Definition ready (placed : list vertex) (x : vertex) : bool :=
    forallb (fun y => if in_dec same y placed then true else false) (predecessors x).

  (** The loop [while waiting]: the order of what waits, or on the right what is left when nothing is ready. Every round places
      something, so that as many rounds as there are vertices are enough. *)
  Fixpoint in_rounds (rounds : nat) (placed waiting : list vertex) : list vertex + list vertex :=
    match waiting, rounds with
    | [], _ => inl []
    | _, 0 => inr waiting
    | _, S rounds =>
        match partition (ready placed) waiting with
        | ([], _) => inr waiting
        | (now, later) =>
            match in_rounds rounds (placed ++ now) later with
            | inl order => inl (now ++ order)
            | inr stuck => inr stuck
            end
        end
    end.

  Definition topological_order (vertices : list vertex) : list vertex + list vertex :=
    in_rounds (length vertices) [] vertices.

  (** The predecessors of each vertex are in [placed] or stand before it. *)
  Inductive topological : list vertex -> list vertex -> Prop :=
  | topological_nil : forall placed, topological placed []
  | topological_cons : forall placed x order,
      incl (predecessors x) placed -> topological (x :: placed) order -> topological placed (x :: order).

  Lemma ready_says placed x : ready placed x = true <-> incl (predecessors x) placed.
  Proof.
    unfold ready. rewrite forallb_forall.
    split; intros H y Hy; specialize (H y Hy); destruct (in_dec same y placed); auto; discriminate.
  Qed.

  Lemma partition_says (f : vertex -> bool) l now later :
    partition f l = (now, later) ->
    Permutation l (now ++ later) /\ (forall x, In x now -> f x = true) /\ (forall x, In x later -> f x = false).
  Proof.
    revert now later; induction l as [|a l IH]; intros now later H; simpl in H.
    - inversion H; subst; simpl; repeat split; try reflexivity; intros ? [].
    - destruct (partition f l) as [n r]. destruct (IH n r eq_refl) as (P & N & L).
      destruct (f a) eqn:F; inversion H; subst; clear H; repeat split; auto.
      + simpl; now constructor.
      + intros x [<-|Hx]; auto.
      + rewrite P. apply Permutation_middle.
      + intros x [<-|Hx]; auto.
  Qed.

  Lemma topological_more placed placed' order :
    incl placed placed' -> topological placed order -> topological placed' order.
  Proof.
    intros I T; revert placed' I; induction T as [|placed x order D T IH]; intros placed' I; constructor.
    - eapply incl_tran; eauto.
    - apply IH. intros y [<-|Hy]; [now left | right; auto].
  Qed.

  Lemma topological_after_ready now : forall placed order,
    (forall x, In x now -> ready placed x = true) -> topological (placed ++ now) order -> topological placed (now ++ order).
  Proof.
    induction now as [|x now IH]; intros placed order R T; simpl.
    - now rewrite app_nil_r in T.
    - constructor; [apply ready_says, R; now left|]. apply IH.
      + intros y Hy. apply ready_says. apply incl_tl. apply ready_says, R. now right.
      + eapply topological_more; [|exact T]. intros y Hy. rewrite in_app_iff in Hy; simpl in Hy.
        simpl. rewrite in_app_iff. tauto.
  Qed.

  Lemma in_rounds_found rounds : forall placed waiting order,
    in_rounds rounds placed waiting = inl order -> Permutation waiting order /\ topological placed order.
  Proof.
    induction rounds as [|k IH]; intros placed [|a w] order H; cbn [in_rounds] in H;
      try discriminate; try (inversion H; split; constructor).
    destruct (partition (ready placed) (a :: w)) as [now later] eqn:Q.
    destruct (partition_says _ _ _ _ Q) as (P & N & _).
    destruct now as [|x now]; [discriminate|].
    destruct (in_rounds k (placed ++ x :: now) later) as [o|] eqn:K; [|discriminate].
    inversion H; subst. destruct (IH _ _ _ K) as [P' T]. split.
    - rewrite P. simpl. constructor. now apply Permutation_app_head.
    - apply (topological_after_ready (x :: now)); auto.
  Qed.

  Theorem the_order_found_is_topological vertices order :
    topological_order vertices = inl order -> Permutation vertices order /\ topological [] order.
  Proof. apply in_rounds_found. Qed.

  (** What is left has only predecessors that are left. *)
  Lemma in_rounds_stuck rounds : forall placed waiting stuck,
    length waiting <= rounds ->
    (forall x, In x waiting -> incl (predecessors x) (placed ++ waiting)) ->
    in_rounds rounds placed waiting = inr stuck ->
    stuck <> [] /\ incl stuck waiting /\ forall x, In x stuck -> exists y, In y stuck /\ In y (predecessors x).
  Proof.
    induction rounds as [|k IH]; intros placed [|a w] stuck L C H; cbn [in_rounds] in H; try discriminate; simpl in L; [lia|].
    destruct (partition (ready placed) (a :: w)) as [now later] eqn:Q.
    destruct (partition_says _ _ _ _ Q) as (P & N & W).
    destruct now as [|x now].
    - inversion H; subst. split; [discriminate|]. split; [apply incl_refl|].
      intros x Hx. simpl in P. assert (In x later) as Hl by now rewrite <- P.
      apply W in Hl. unfold ready in Hl.
      destruct (Exists_dec (fun y => ~ In y placed) (predecessors x)) as [E|E].
      + intros y. destruct (in_dec same y placed); auto.
      + apply Exists_exists in E as (y & Hy & Ny). exists y. split; auto.
        destruct (in_app_or _ _ _ (C x Hx y Hy)); tauto.
      + exfalso. rewrite <- not_true_iff_false in Hl. apply Hl. apply forallb_forall. intros y Hy.
        destruct (in_dec same y placed); auto. exfalso; apply E, Exists_exists; eauto.
    - destruct (in_rounds k (placed ++ x :: now) later) as [o|found] eqn:K; [discriminate|]. inversion H; subst found.
      assert (length later <= k) as Lk.
      { apply Permutation_length in P. rewrite app_length in P. simpl in P. lia. }
      destruct (IH (placed ++ x :: now) later stuck Lk) with (2 := K) as (NE & I & E).
      + intros z Hz y Hy. assert (In z (a :: w)) as Hzw by (rewrite P, in_app_iff; auto).
        specialize (C z Hzw y Hy). rewrite in_app_iff in C. rewrite P, in_app_iff in C.
        rewrite !in_app_iff. tauto.
      + split; auto. split; auto. intros y Hy. rewrite P, in_app_iff. right. now apply I.
  Qed.

  (** What is left out of an order hangs on no cycle: whatever has been placed is accessible, and so is what is ready then. *)
  Lemma what_is_not_stuck_is_accessible rounds (precedes : vertex -> vertex -> Prop) : forall placed waiting stuck,
    (forall x y, In x (placed ++ waiting) -> precedes y x -> In y (predecessors x)) ->
    (forall x, In x placed -> Acc precedes x) ->
    in_rounds rounds placed waiting = inr stuck ->
    forall x, In x waiting -> ~ In x stuck -> Acc precedes x.
  Proof.
    induction rounds as [|k IH]; intros placed [|a w] stuck E A H x Hx N; cbn [in_rounds] in H; try discriminate;
      try (inversion H; subst; contradiction).
    destruct (partition (ready placed) (a :: w)) as [now later] eqn:Q.
    destruct (partition_says _ _ _ _ Q) as (P & R & _).
    destruct now as [|b now]; [inversion H; subst; contradiction|].
    destruct (in_rounds k (placed ++ b :: now) later) as [o|found] eqn:K; [discriminate|]. inversion H; subst found.
    assert (forall y, In y (b :: now) -> Acc precedes y) as Now.
    { intros y Hy. constructor. intros z Hz. apply A. apply (proj1 (ready_says placed y) (R y Hy)).
      apply E; auto. apply in_or_app. right. rewrite P. apply in_or_app. now left. }
    rewrite P in Hx. apply in_app_or in Hx as [Hx|Hx]; [now apply Now|].
    apply (IH (placed ++ b :: now) later stuck); auto.
    - intros u v Hu. apply E. rewrite P. rewrite <- app_assoc in Hu. exact Hu.
    - intros y Hy. apply in_app_or in Hy as [Hy|Hy]; auto.
  Qed.

  Theorem what_is_left_depends_on_what_is_left_and_nothing_else_hangs_on_a_cycle vertices stuck (precedes : vertex -> vertex -> Prop) :
    (forall x, In x vertices -> incl (predecessors x) vertices) ->
    (forall x y, In x vertices -> (precedes y x <-> In y (predecessors x))) ->
    topological_order vertices = inr stuck ->
    stuck <> [] /\ incl stuck vertices /\ (forall x, In x stuck -> exists y, In y stuck /\ precedes y x) /\
    forall x, In x vertices -> ~ In x stuck -> Acc precedes x.
  Proof.
    intros C E H. pose proof (in_rounds_stuck (length vertices) [] vertices stuck (le_n _) C H) as (NE & I & S).
    split; [exact NE|]. split; [exact I|]. split.
    - intros x Hx. destruct (S x Hx) as (y & Hy & P). exists y. split; [exact Hy|]. apply E; auto.
    - apply (what_is_not_stuck_is_accessible (length vertices) precedes [] vertices stuck); auto; [|easy].
      intros x y Hx. now apply E.
  Qed.

  (** In a finite set in which everything has a predecessor, there is a cycle. *)
  Lemma a_cycle_among l : forall precedes : vertex -> vertex -> Prop,
    l <> [] -> (forall x, In x l -> exists y, In y l /\ precedes y x) -> exists x, clos_trans _ precedes x x.
  Proof.
    induction l as [|a l IH]; intros precedes NE H; [congruence|].
    destruct (H a) as (y & Hy & Ya); [now left|].
    destruct (same y a) as [->|D]; [exists a; now constructor|].
    destruct Hy as [<-|Hy]; [congruence|].
    (* without a: an edge for each path of two edges through a *)
    destruct (IH (fun u v => precedes u v \/ (precedes u a /\ precedes a v))) as (x & Hx).
    - intros ->; destruct Hy.
    - intros x Hx. destruct (H x) as (z & [<-|Hz] & Z); [now right| |]; eauto.
    - exists x. clear - Hx. revert Hx. generalize x at 1 3. intros z Hx.
      induction Hx as [u v [E|[E F]]|u v w]; [now apply t_step| |]; eapply t_trans; eauto using t_step.
  Qed.

  Theorem no_order_is_found_only_if_there_is_a_cycle vertices stuck (precedes : vertex -> vertex -> Prop) :
    (forall x, In x vertices -> incl (predecessors x) vertices) ->
    (forall x y, In x vertices -> In y (predecessors x) -> precedes y x) ->
    topological_order vertices = inr stuck -> exists x, clos_trans _ precedes x x.
  Proof.
    intros C E H. apply in_rounds_stuck in H as (NE & I & S); auto.
    apply (a_cycle_among stuck); auto. intros x Hx. destruct (S x Hx) as (y & Hy & P). eauto.
  Qed.

  Theorem what_has_a_topological_order_has_no_cycle order (precedes : vertex -> vertex -> Prop) :
    (forall x y, precedes y x -> In x order /\ In y (predecessors x)) ->
    topological [] order -> forall x, ~ clos_trans _ precedes x x.
  Proof.
    intros E T.
    assert (forall placed o, topological placed o -> (forall x y, precedes y x -> In y (predecessors x)) ->
              (forall x, In x placed -> Acc precedes x) -> forall x, In x o -> Acc precedes x) as W.
    { clear. intros placed o T E. induction T as [|placed x o D T IH]; intros A z Hz; [easy|].
      assert (Acc precedes x) as Ax by (constructor; intros y Hy; apply A, D; eauto).
      destruct Hz as [<-|Hz]; auto. apply IH; auto. intros u [<-|Hu]; auto. }
    assert (well_founded precedes) as WF.
    { intros x. constructor. intros y Hy. destruct (E _ _ Hy) as [Hx _].
      assert (Acc precedes x) as Ax by (apply (W [] order); auto; [intros ? ? Q; now apply E in Q|intros ? []]).
      now apply (Acc_inv Ax). }
    intros x C. apply wf_clos_trans in WF. induction (WF x) as [x _ IH]. exact (IH x C C).
  Qed.
End Ordering.
