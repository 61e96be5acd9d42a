//! Macros that options share: methods to read them, and recipes, one enum per trait, whose variants are the
//! strategies themselves.

/// Gives options a method to read each of these fields, of the name that its `with_*` method has: values are copied, those
/// of a type after `&` lent; `in part` for fields of a part, `@[...]` for generics.
macro_rules! readable {
    (& $(@[$($generics:tt)*])? $name:ty { $($field:ident: $type:ty),* $(,)? }) => {
        impl $(<$($generics)*>)? $name {
            $(
                #[doc = concat!("The value set by [`with_", stringify!($field), "`](Self::with_", stringify!($field), ").")]
                pub fn $field(&self) -> &$type {
                    &self.$field
                }
            )*
        }
    };
    (in $part:ident: $name:ty { $($field:ident: $type:ty),* $(,)? }) => {
        impl $name {
            $(
                #[doc = concat!("The value set by [`with_", stringify!($field), "`](Self::with_", stringify!($field), ").")]
                pub fn $field(&self) -> $type {
                    self.$part.$field
                }
            )*
        }
    };
    ($(@[$($generics:tt)*])? $name:ty { $($field:ident: $type:ty),* $(,)? }) => {
        impl $(<$($generics)*>)? $name {
            $(
                #[doc = concat!("The value set by [`with_", stringify!($field), "`](Self::with_", stringify!($field), ").")]
                pub fn $field(&self) -> $type {
                    self.$field
                }
            )*
        }
    };
}

/// Gives a type of one part or two a method that puts other parts in their places and keeps the other fields.
macro_rules! mapped {
    ($name:ident { $part:ident; $($field:ident),* }) => {
        impl<A> $name<A> {
            /// The same with another part.
            pub(crate) fn map<B>(self, part: impl FnOnce(A) -> B) -> $name<B> {
                $name { $part: part(self.$part), $($field: self.$field),* }
            }
        }
    };
    ($name:ident { $first:ident, $second:ident; $($field:ident),* }) => {
        impl<A, B> $name<A, B> {
            /// The same with other parts.
            pub(crate) fn map<C, D>(self, first: impl FnOnce(A) -> C, second: impl FnOnce(B) -> D) -> $name<C, D> {
                $name { $first: first(self.$first), $second: second(self.$second), $($field: self.$field),* }
            }
        }
    };
}

/// An enum over strategies that implement one trait: units, plain ones, and those with one part or two that are recipes
/// too. Comes with `From` each strategy and with what its implementation of the trait forwards to.
macro_rules! recipe {
    (
        $(#[$meta:meta])*
        $name:ident: $trait:ident {
            $(unit $unit:ident,)*
            $(plain $plain:ident,)*
            $(nested $nested:ident<$part:ty>,)*
            $(pair $pair:ident<$first:ty, $second:ty>,)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
        #[non_exhaustive]
        pub enum $name {
            $(#[doc = concat!("[`", stringify!($unit), "`].")] $unit,)*
            $(#[doc = concat!("[`", stringify!($plain), "`].")] $plain($plain),)*
            $(#[doc = concat!("[`", stringify!($nested), "`].")] $nested(Box<$nested<$part>>),)*
            $(#[doc = concat!("[`", stringify!($pair), "`].")] $pair(Box<$pair<$first, $second>>),)*
        }

        impl $name {
            /// The strategy itself.
            fn strategy(&self) -> &dyn $trait {
                match self {
                    $(Self::$unit => &$unit,)*
                    $(Self::$plain(plain) => plain,)*
                    $(Self::$nested(nested) => &**nested,)*
                    $(Self::$pair(pair) => &**pair,)*
                }
            }

            /// The strategy itself, to be shared.
            #[allow(dead_code, reason = "parts of others are not shared")]
            pub(crate) fn shared(self) -> std::sync::Arc<dyn $trait> {
                use std::sync::Arc;
                match self {
                    $(Self::$unit => Arc::new($unit),)*
                    $(Self::$plain(plain) => Arc::new(plain),)*
                    $(Self::$nested(nested) => Arc::new(*nested),)*
                    $(Self::$pair(pair) => Arc::new(*pair),)*
                }
            }
        }

        $(impl From<$unit> for $name {
            fn from(_: $unit) -> Self {
                Self::$unit
            }
        })*
        $(impl From<$plain> for $name {
            fn from(plain: $plain) -> Self {
                Self::$plain(plain)
            }
        })*
        $(impl<A: Into<$part>> From<$nested<A>> for $name {
            fn from(nested: $nested<A>) -> Self {
                Self::$nested(Box::new(nested.map(Into::into)))
            }
        })*
        $(impl<A: Into<$first>, B: Into<$second>> From<$pair<A, B>> for $name {
            fn from(pair: $pair<A, B>) -> Self {
                Self::$pair(Box::new(pair.map(Into::into, Into::into)))
            }
        })*
    };
}

pub(crate) use {mapped, readable, recipe};
