//! The representations between the stages, in pipeline order.
