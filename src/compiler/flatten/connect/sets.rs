//! Connection sets: a union-find over the variables of connectors.

use crate::ir::expr::VarId;
use crate::ir::flat::Origin;

/// A variable of a connector, and whether the connection sees it as an outside connector.
pub(super) type SetMember = (VarId, bool);

/// Connection sets (union-find with path halving), in order of first occurrence.
#[derive(Default)]
pub(super) struct ConnectionSets {
    /// The number of each variable's member as inside and as outside connector, 0 for none.
    pub(super) number: Vec<[u32; 2]>,
    members: Vec<SetMember>,
    parent: Vec<usize>,
    origins: Vec<Origin>,
}

impl ConnectionSets {
    pub(super) fn number(&self, (v, outside): SetMember) -> Option<usize> {
        let numbers = self.number.get(v.0 as usize)?;
        (numbers[usize::from(outside)] as usize).checked_sub(1)
    }

    pub(super) fn add(&mut self, member: SetMember, origin: &Origin) -> usize {
        if let Some(k) = self.number(member) {
            return k;
        }
        let k = self.members.len();
        let (v, outside) = (member.0.0 as usize, member.1);
        if self.number.len() <= v {
            self.number.resize(v + 1, [0; 2]);
        }
        self.number[v][usize::from(outside)] = k as u32 + 1;
        self.members.push(member);
        self.parent.push(k);
        self.origins.push(origin.clone());
        k
    }

    pub(super) fn root(&mut self, mut k: usize) -> usize {
        while self.parent[k] != k {
            self.parent[k] = self.parent[self.parent[k]];
            k = self.parent[k];
        }
        k
    }

    pub(super) fn join(&mut self, a: SetMember, b: SetMember, origin: &Origin) {
        let (a, b) = (self.add(a, origin), self.add(b, origin));
        let (a, b) = (self.root(a), self.root(b));
        // The older set keeps its number, which preserves the order of the source.
        self.parent[a.max(b)] = a.min(b);
    }

    /// Each set with the origin of the first connection in it.
    pub(super) fn sets(&mut self) -> Vec<(Vec<SetMember>, Origin)> {
        let mut at: Vec<Option<usize>> = vec![None; self.members.len()];
        let mut out: Vec<(Vec<SetMember>, Origin)> = Vec::new();
        for k in 0..self.members.len() {
            let root = self.root(k);
            let slot = *at[root].get_or_insert_with(|| {
                out.push((Vec::new(), self.origins[k].clone()));
                out.len() - 1
            });
            out[slot].0.push(self.members[k]);
        }
        out
    }
}
