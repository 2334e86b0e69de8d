//! Finding the physical effects that a model lacks.
//!
//! *In:* a plan, its recordings and the catalogue of effects ([`catalogue`]). *Out:* a verdict, the effects
//! with their parameters ([`result`]), an amended model ([`amended_model`]), a [`summary`], a page ([`page`]) and
//! `diagnosis.json` ([`json`]). [`run`] is the whole workflow for any front end.
//!
//! A [`hypothesis`] is the model with certain effects at certain places, fitted to the recordings. The
//! [`search`] extends hypotheses step by step: every effect is scored at every place ([`rank`], [`score`]),
//! the most promising are fitted ([`preliminary_fit`], [`candidate_fit`]) and compared ([`preference`]). All
//! thresholds stand in [`policy`].

pub mod adapter;
pub mod alike_components;
pub mod alternatives;
pub mod amended_model;
pub mod backward_elimination;
pub mod balance;
pub mod candidate_fit;
pub mod catalogue;
pub mod cause;
pub mod curve_points;
pub mod difference;
pub mod effective_evidence;
pub mod equal_variables;
pub mod equation_terms;
pub mod finer_curve;
pub mod fixed_value;
pub mod follower;
pub mod following;
pub mod formula;
pub mod formula_fit;
pub mod forward_selection;
pub mod grade;
pub mod held_amplitude;
pub mod hypothesis;
pub mod inner_signals;
pub mod json;
pub mod law_choice;
pub mod law_refinement;
pub mod linearise;
pub mod merge;
pub mod model_source;
pub mod next_experiment;
pub mod next_text;
pub mod noise;
pub mod page;
pub mod pairwise_selection;
pub mod place;
pub mod policy;
pub mod preference;
pub mod preliminary_fit;
pub mod rank;
pub mod regrid;
pub mod residual;
pub mod result;
pub mod revise;
pub mod rival_curves;
pub mod rivals;
pub mod run;
pub mod score;
pub mod search;
pub mod separate_starts;
pub mod shape_parameters;
pub mod sibling_laws;
pub mod study;
pub mod summary;
pub mod surroundings;
pub mod terminal_reading;
pub mod variation;
