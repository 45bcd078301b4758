"""Masses of soft blocks between stiff joints."""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from runningbond.dynamics import BlockSystem
from runningbond.dynamics.system import Coupling

from .frequency_shift import elastic_stiffness
from .mass_scaling import _kinds, _rigid_bound, ScaledModes
from .modal_wall import ModalWall

MOST = 100
SHARE = 2.0
OWN = 1.452
import os
TARGET=float(os.environ.get('TARGET','1'))

def coupled(wall: ModalWall, system: BlockSystem, damping: float=0.05) -> BlockSystem:
    scene = wall.scene
    if (~scene.fixed).sum() > MOST: return system
    moving = np.isfinite(wall.mass)
    rigid = moving & (wall.stiffness == 0)
    K = elastic_stiffness(wall).toarray()
    r = rigid[moving]
    m = wall.mass[moving]
    if not (~r).any(): return system
    low = lambda K, m: float(eigh(K, np.diag(m) if m.ndim==1 else m, eigvals_only=True, subset_by_index=(0, 0))[0])
    first, firstr = low(K, m), low(K[np.ix_(r, r)], m[r])
    kinds = min((_kinds(wall, exponent) for exponent in (0.0, 0.5, 1.0)), key=_rigid_bound)
    bound = _rigid_bound(kinds)
    square = system.interface.frequency_squared
    ratio = np.sqrt(square/bound*firstr/first)
    print('N/N_r %.2f'%ratio)
    if ratio < 2: return system
    fit = bound*first/firstr/TARGET**2
    S = np.zeros((len(m), len(m)))
    # share bound of deformations: row sums of K_dd's blocks, own side twice
    Kj = K - np.diag(wall.stiffness[moving])
    d = ~r
    D = 1/np.sqrt(np.maximum(np.diag(Kj)[d], 1e-300))
    C = np.abs(Kj[np.ix_(d,d)])*D[:,None]*D
    s = np.diag(Kj)[d]*C.sum(axis=1)
    k = wall.stiffness[moving][d]
    mass = system.mass.copy()
    md = m[d] + OWN*(k+(1+1/SHARE)*s)/fit
    where = np.flatnonzero(moving)
    mass[where[r]] = wall.mass[where[r]]
    mass[where[d]] = md
    visc = np.zeros_like(mass); visc[where[d]] = 2*damping*np.sqrt(k*md)
    P = (1+SHARE)/fit*Kj[np.ix_(r,r)]
    M = np.diag(mass[moving]); M[np.ix_(r,r)] += P
    new = low(K, M)
    top = float(eigh(K, M, eigvals_only=True, subset_by_index=(len(m)-1, len(m)-1))[0])
    print('lost %.3f of first, highest/allowed %.2f, N was %.0f now ~ %.0f'%(1-np.sqrt(new/first), np.sqrt(top/fit), 2*np.pi/np.sqrt(first)/1.3*np.sqrt(square),2*np.pi/np.sqrt(new)/1.3*np.sqrt(fit)))
    return replace(system, mass=mass, viscosity=visc, interface=replace(system.interface, frequency_squared=fit),
        coupling=Coupling(where[r], P))
